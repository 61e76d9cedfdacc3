"""The figures of a run: those its scenario requests, and those every run gets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from ..errors import DosekiError, UserError, one_line
from ..measure.flow import measure_flow
from ..measure.views import tables, tilt, whole_space
from ..record.beginning import refuse_links
from ..record.reader import Run, load
from ..scenario.tables.figure import Figure as FigureTable
from ..util.files import clear_errors, write_whole
from .flow import draw_flow
from .kinds.moments import spread
from .kinds.registry import draw
from .kinds.series import ENERGIES, MASSES, draw_history
from .kinds.snapshot import Panels, draw_panels
from .text import plain_text


@dataclass
class Drawn:
    """The pictures of a run, and what is to be said of those that are missing, or not as wanted."""

    pictures: list[Path] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def remarks(self) -> list[str]:
        """All that is to be said."""
        return [*self.failures, *self.warnings]


def draw_run(directory: str | Path) -> Drawn:
    """Draw every figure of the run in `directory` into DIR/figures, as PNG files.

    A figure that fails keeps no other from being drawn.  Raises UserError when there is no run, or
    no snapshot.
    """
    run = load(directory)
    if not len(run):
        raise UserError(f"{directory}: the run has no snapshot to draw")
    refuse_links(run.folder)
    drawn = Drawn()
    for name, make in _makers(run):
        try:
            with plain_text() as complaints:
                if (figure := make()) is not None:
                    drawn.pictures.append(_save(figure, run, name))
            drawn.warnings += [f"figure {name}: {text}" for text in complaints]
        except Exception as error:
            # Whatever a picture stumbles over: the run, and the other pictures, do not.
            said = str(error) if isinstance(error, DosekiError) else repr(error)
            drawn.failures.append(one_line(f"figure {name} could not be drawn: {said}"))
    return drawn


def plot_run(directory: str | Path) -> list[Path]:
    """The same; returns the pictures, or raises UserError where one could not be drawn."""
    drawn = draw_run(directory)
    if drawn.failures:
        raise UserError(drawn.failures[0])
    return drawn.pictures


def figures(run: Run) -> Iterator[tuple[str, Figure]]:
    """Every figure of a run with its name, one after the other."""
    for name, make in _makers(run):
        if (figure := make()) is not None:
            yield name, figure


def _makers(run: Run) -> Iterator[tuple[str, Callable[[], Figure | None]]]:
    """The name of each figure and what draws it, or finds nothing to be drawn.

    A figure of the scenario replaces a general one of the same name.
    """
    requested = tables(run, "figure", FigureTable)
    for name, make in GENERAL.items():
        if name not in requested:
            yield name, partial(make, run)
    for name, table in requested.items():
        yield name, partial(draw, run, name, table)


def _energy(run: Run) -> Figure | None:
    known = set(ENERGIES) <= set(run.history)
    return draw_history(run, ENERGIES, "Energy") if known else None


def _mass(run: Run) -> Figure | None:
    known = set(MASSES) <= set(run.history)
    return draw_history(run, MASSES, "Mass ledger") if known else None


def _flow(run: Run) -> Figure | None:
    flow = measure_flow(run)
    return draw_flow(run, flow) if flow is not None else None


def _overview(run: Run) -> Figure:
    """The whole domain at the start, in the middle and at the end, gravity pointing down."""
    view = whole_space(run.scenario["dim"], rotate=-tilt(run))
    what = Panels(view, ["material"], run.scenario.get("title", ""))
    return draw_panels(run, spread(run, 3), what)


GENERAL: dict[str, Callable[[Run], Figure | None]] = {
    "overview": _overview,
    "energy": _energy,
    "mass": _mass,
    "flow": _flow,
}


def _save(figure: Figure, run: Run, name: str) -> Path:
    path = run.folder.figures / f"{name}.png"
    with clear_errors(path):
        path.parent.mkdir(exist_ok=True)
    write_whole(path, lambda temporary: figure.savefig(temporary, format="png"))
    return path
