"""Pictures of the particles: one panel for each time, colour and way of drawing them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from matplotlib.figure import Figure

from ...measure.moments import Moment
from ...measure.views import named_window
from ...record.reader import Run
from ...scenario.tables.figure import SnapshotFigure
from ..colouring import colouring
from ..dots import dots, draw_particles, extent_of, outside_text
from ..layout import SMALL, Extent, PanelGrid, moment_text, name_axes
from ..space.ground import draw_ground
from .moments import chosen
from .panels import Panels
from .spatial import draw_spatial

FEW = 2000  # a run of no more particles is also drawn with the support, as Figs. 3 and 4
FLAT = 0.5  # panels flatter than this stand one below the other


def draw_snapshots(run: Run, name: str, table: SnapshotFigure) -> Figure:
    """The figure [figure.NAME] of particles at some moments."""
    view = named_window(run, table.window)
    moments = chosen(run, table, view)
    few = table.window is None and max(len(run[m.index]["id"]) for m in moments) <= FEW
    few &= not any((run[m.index]["grain"] >= 0).any() for m in moments)  # bodies are drawn to scale
    sizes = ("support", "grain") if few else ("grain",)
    what = Panels(view, table.colour, table.title or view.title, sizes, table.material)
    return draw_panels(run, moments, what)


def draw_panels(run: Run, moments: Sequence[Moment], what: Panels) -> Figure:
    """One row for each moment, one column for each colour and size; in 3-D see draw_spatial.

    Panels that are flat stand below each other, colour after colour.
    """
    if run.scenario["dim"] == 3:
        return draw_spatial(run, moments, what)
    snapshots = [run[moment.index] for moment in moments]
    extent = extent_of(snapshots, what.view, what.sizes[0])
    kinds = list(product(what.colours, what.sizes))
    columns = len(what.sizes) if _is_flat(extent) else len(kinds)
    panels = list(product(zip(moments, snapshots, strict=True), kinds))
    key_after = [column % len(what.sizes) == len(what.sizes) - 1 for column in range(columns)]
    grid = PanelGrid(len(panels) // columns, key_after, extent, what.title)
    colours = {name: colouring(run, snapshots, name, what.view) for name in what.colours}
    for number, ((moment, snapshot), (name, size)) in enumerate(panels):
        row, column = divmod(number, columns)
        axes = grid.panel(row, column)
        shown = dots(snapshot, what.view, size, what.material)
        draw_ground(axes, run, what.view, extent)
        draw_particles(axes, snapshot, shown, colours[name], extent)
        name_axes(axes, snapshot.dim, what.view.rotate)
        title = what.panel_title(moment_text(run, moment), size)
        axes.set_title(title + outside_text(snapshot, what.view, shown, extent), **SMALL)
        if key_after[column] and number < len(kinds):
            colours[name].add_key(grid, axes)
    return grid.figure


def _is_flat(extent: Extent) -> bool:
    left, right, bottom, top = extent
    return top - bottom < FLAT * (right - left)
