"""The figures of a run: those its scenario requests, and those every run gets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from ..errors import UserError
from ..measure.flow import measure_flow
from ..measure.moments import moments
from ..measure.views import tables, tilt, whole_space
from ..record.reader import Run, load
from ..scenario.tables.figure import Figure as FigureTable
from ..util.spelling import suggestion
from .flow import draw_flow
from .kinds.energy import draw_energy
from .kinds.panels import Panels
from .kinds.registry import draw
from .kinds.series import MASSES, draw_history
from .kinds.snapshot import draw_panels
from .maps.output import map_makers
from .nothing import NothingToDrawError
from .saving import Drawn
from .text import plain_text


def draw_run(directory: str | Path) -> Drawn:
    """Draw every figure of the run in `directory` into DIR/figures, as PNG files, and its maps.

    A figure that fails keeps no other from being drawn.  Raises UserError when there is no run, or
    no snapshot.
    """
    run = load(directory)
    if not len(run):
        raise UserError(f"{directory}: the run has no snapshot to draw")
    drawn = Drawn()
    for name, make in _makers(run):
        drawn.add(run.folder.figures / f"{name}.png", make)
    for name, make in map_makers(run):
        drawn.add(run.folder.maps / f"{name}.png", make)
    return drawn


def plot_run(directory: str | Path) -> list[Path]:
    """The same; returns the pictures, or raises UserError where one could not be drawn.

    ResourceError where memory or disk ran out.
    """
    drawn = draw_run(directory)
    drawn.check("".join(drawn.failures[:1]))
    return drawn.pictures


def figures(run: Run) -> Iterator[tuple[str, Figure]]:
    """Every figure of a run that has something to show with its name, one after the other."""
    for name, make in _makers(run):
        with suppress(NothingToDrawError):
            yield name, make()


def figure_names(run: Run) -> list[str]:
    """Names of the figures of a run, those among them that may have nothing to show."""
    return [name for name, _ in _makers(run)]


def make_figure(run: Run, name: str) -> Figure:
    """One of them; raises UserError for another name, and where there is nothing to draw."""
    known = dict(_makers(run))
    if name not in known:
        raise UserError(f"{run.directory}: no figure is called {name!r}{suggestion(name, known)}")
    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot to draw")
    try:
        with plain_text():
            return known[name]()
    except NothingToDrawError as reason:
        raise UserError(f"{run.directory}: figure {name} is not drawn: {reason}") from None


def _makers(run: Run) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """The name of each figure and what draws it, or raises NothingToDrawError.

    A figure of the scenario replaces a general one of the same name.
    """
    requested = tables(run, "figure", FigureTable)
    for name, make in GENERAL.items():
        if name not in requested:
            yield name, partial(make, run)
    for name, table in requested.items():
        yield name, partial(draw, run, name, table)


def _mass(run: Run) -> Figure:
    if not set(MASSES) <= set(run.history):
        raise NothingToDrawError("the history has no ledger of mass")
    if not any(run.history[column].any() for column in MASSES if column != "mass_inside"):
        raise NothingToDrawError("no mass enters or leaves")
    return draw_history(run, MASSES, "Mass ledger")


def _flow(run: Run) -> Figure:
    flow = measure_flow(run)
    if flow is None:
        raise NothingToDrawError("there is no fluid")
    return draw_flow(run, flow)


def _overview(run: Run) -> Figure:
    """Everything at the start, when the flow arrives, at its peak, and at the end; gravity down."""
    view = whole_space(run.scenario["dim"], rotate=-tilt(run))
    what = Panels(view, ["material"], run.scenario.get("title", ""))
    return draw_panels(run, moments(run, view), what)


GENERAL: dict[str, Callable[[Run], Figure]] = {
    "overview": _overview,
    "energy": draw_energy,
    "mass": _mass,
    "flow": _flow,
}
