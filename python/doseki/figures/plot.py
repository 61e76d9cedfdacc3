"""The figures of a run: those its scenario requests, and those every run gets."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from matplotlib.figure import Figure

from ..errors import UserError
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


def plot_run(directory: str | Path) -> list[Path]:
    """Draw every figure of the run in `directory` into DIR/figures; returns the PNG files.

    Raises UserError when there is no run, no snapshot, or a figure that cannot be drawn.
    """
    run = load(directory)
    if not len(run):
        raise UserError(f"{directory}: the run has no snapshot to draw")
    refuse_links(run.folder)
    return [_save(figure, run, name) for name, figure in figures(run)]


def figures(run: Run) -> Iterator[tuple[str, Figure]]:
    """Every figure of a run with its name, one after the other.

    A figure of the scenario replaces a general one of the same name.
    """
    requested = tables(run, "figure", FigureTable)
    for name, make in GENERAL.items():
        if name not in requested and (figure := make(run)) is not None:
            yield name, figure
    for name, table in requested.items():
        yield name, draw(run, name, table)


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


GENERAL = {"overview": _overview, "energy": _energy, "mass": _mass, "flow": _flow}


def _save(figure: Figure, run: Run, name: str) -> Path:
    path = run.folder.figures / f"{name}.png"
    with clear_errors(path):
        path.parent.mkdir(exist_ok=True)
    write_whole(path, lambda temporary: figure.savefig(temporary, format="png"))
    return path
