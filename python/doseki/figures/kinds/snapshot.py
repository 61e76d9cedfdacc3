"""Pictures of the particles: one panel for each time, colour and way of drawing them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from matplotlib.figure import Figure

from ...measure.views import View, named_window
from ...record.reader import Run, Snapshot
from ...scenario.tables.figure import SnapshotFigure
from ..colouring import colouring
from ..dots import dots, draw_particles, extent_of
from ..layout import Extent, PanelGrid, name_axes, time_text
from .moments import caption, chosen

FEW = 2000  # a run of no more particles is also drawn with the support, as Figs. 3 and 4
FLAT = 0.5  # panels flatter than this stand one below the other
SIZES = {"grain": "to scale", "support": "circles of radius H h"}


@dataclass(frozen=True)
class Panels:
    """What is drawn: quantities as colours, and circles by `sizes` (see dots.dots)."""

    view: View
    colours: Sequence[str]
    title: str = ""
    sizes: Sequence[str] = ("grain",)
    material: str | None = None

    def panel_title(self, time: str, size: str) -> str:
        """The time, and how the particles are drawn where there is a choice."""
        return f"{time}, {SIZES[size]}" if len(self.sizes) > 1 else time


def draw_snapshots(run: Run, name: str, table: SnapshotFigure) -> Figure:
    """The figure [figure.NAME] of particles at some moments."""
    view = named_window(run, table.window)
    snapshots = chosen(run, table, view)
    few = table.window is None and max(len(s["id"]) for s in snapshots) <= FEW
    sizes = ("support", "grain") if few else ("grain",)
    title = caption(run, table, view, snapshots)
    what = Panels(view, table.colour, title, sizes, table.material)
    return draw_panels(run, snapshots, what)


def draw_panels(run: Run, snapshots: Sequence[Snapshot], what: Panels) -> Figure:
    """One row for each snapshot, one column for each colour and size.

    Panels that are flat stand below each other, colour after colour.
    """
    extent = extent_of(snapshots, what.view, what.sizes[0])
    kinds = list(product(what.colours, what.sizes))
    columns = len(what.sizes) if _is_flat(extent) else len(kinds)
    panels = list(product(snapshots, kinds))
    key_after = [column % len(what.sizes) == len(what.sizes) - 1 for column in range(columns)]
    grid = PanelGrid(len(panels) // columns, key_after, extent, what.title)
    colours = {name: colouring(run, snapshots, name, what.view) for name in what.colours}
    for number, (snapshot, (name, size)) in enumerate(panels):
        row, column = divmod(number, columns)
        axes = grid.panel(row, column)
        shown = dots(snapshot, what.view, size, what.material)
        draw_particles(axes, snapshot, shown, colours[name], extent)
        name_axes(axes, snapshot.dim, what.view.rotate)
        title = what.panel_title(time_text(snapshot.time, run.times[-1]), size)
        axes.set_title(title, fontsize="small", loc="left")
        if key_after[column]:
            colours[name].add_key(grid, axes, first=number < len(kinds))
    return grid.figure


def _is_flat(extent: Extent) -> bool:
    left, right, bottom, top = extent
    return top - bottom < FLAT * (right - left)
