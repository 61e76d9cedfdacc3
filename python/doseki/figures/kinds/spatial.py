"""Pictures of runs in space: the whole in a slanting view, in plan, and in a long section.

On a terrain the slanting view looks back at the flow, and in place of the section, which a valley
would leave, the flow is seen from beside its way.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...measure.moments import Moment
from ...measure.views import View, flow_direction
from ...record.reader import Run, Snapshot
from ..colouring import colouring
from ..dots import Dots, dots, draw_particles, extent_of, outside_text
from ..layout import SMALL, Extent, ViewRows, moment_text, name_axes, scale_bar
from ..space.box import Space, balls_of, seen_extent
from ..space.ground import COLOUR, ground_behind, relief, space_of
from ..space.surfaces import Background, Camera, render
from ..space.way import Way, bed_beside, dots_beside, extent_beside
from .panels import Panels

SLANTING = np.array([0.45, 0.80, -0.42])  # away from the viewer, where the flow runs to -x
DOWN = np.array([0.0, 0.0, -1.0])
PIXELS = 640  # across a picture


def draw_spatial(run: Run, moments: Sequence[Moment], what: Panels) -> Figure:
    """For each moment and colour a slanting view, and a plan and a section side by side."""
    snapshots = [run[moment.index] for moment in moments]
    space = space_of(run, snapshots, what.view)
    section = _section(run, snapshots, space, what)
    cameras = [section.slanting, Camera.looking(DOWN)]
    extents = [seen_extent(space, snapshots, camera) for camera in cameras]
    plan = None if what.view.rotate else relief(run, extents[1], PIXELS)
    behind = [
        ground_behind(run, space, cameras[0], extents[0], PIXELS),
        ground_behind(run, space, cameras[1], extents[1], PIXELS)
        if plan is None
        else Background.flat(plan),
    ]
    rows = list(product(zip(moments, snapshots, strict=True), what.colours))
    grid = ViewRows(len(rows), [*extents, section.extent], what.title)
    colours = {name: colouring(run, snapshots, name, what.view) for name in what.colours}
    for row, ((moment, snapshot), name) in enumerate(rows):
        panels = grid.row(row)
        for k, (camera, extent, axes) in enumerate(zip(cameras, extents, panels, strict=False)):
            balls = balls_of(run, snapshot, colours[name], space, camera, what.material)
            seen = render(balls, camera, extent, PIXELS, behind[k])
            axes.imshow(seen, extent=extent)
            axes.set(xlim=extent[:2], ylim=extent[2:])
        shown = section.dots(snapshot)
        section.draw_bed(panels[2])
        draw_particles(panels[2], snapshot, shown, colours[name], section.extent)
        stray = outside_text(snapshot, what.view, shown, section.extent)
        _name_plan(panels, what.view, moment_text(run, moment))
        section.name(panels[2], stray)
        if row < len(what.colours):
            colours[name].add_key(grid, panels[grid.key_beside])
    return grid.figure


def _section(run: Run, snapshots: Sequence[Snapshot], space: Space, what: Panels) -> _Section:
    all_the_way = [run[0], *snapshots, run[-1]]
    way = None if space.buried is None else Way.between(all_the_way)
    if way is None:
        return _Section(run, snapshots, what)
    return _BesideWay(run, snapshots, what, way, space)


class _Section:
    """The slice along x through the middle of what is shown, and the slanting view beside it."""

    def __init__(self, run: Run, snapshots: Sequence[Snapshot], what: Panels) -> None:
        self._what = what
        self.slanting = Camera.looking(SLANTING * [-(flow_direction(run) or 1), 1, 1])
        self.extent: Extent = extent_of(snapshots, what.view)

    def dots(self, snapshot: Snapshot) -> Dots:
        return dots(snapshot, self._what.view, "grain", self._what.material)

    def draw_bed(self, axes: Axes) -> None:
        """What is below the flow is among the dots."""

    def name(self, axes: Axes, stray: str) -> None:
        axes.set_title(f"long section{stray}", **SMALL)
        name_axes(axes, 3, self._what.view.rotate)


class _BesideWay(_Section):
    """All of a flow from beside its way, over the ground below it."""

    def __init__(
        self, run: Run, snapshots: Sequence[Snapshot], what: Panels, way: Way, space: Space
    ) -> None:
        self._what, self._way, self._space = what, way, space
        self.slanting = way.looking_back()
        clouds = [self.dots(snapshot) for snapshot in snapshots]
        self.extent = extent_beside(clouds)
        self._bed = bed_beside(run, way, snapshots, space, self.extent[:2])

    def dots(self, snapshot: Snapshot) -> Dots:
        return dots_beside(snapshot, self._way, self._space, self._what.material)

    def draw_bed(self, axes: Axes) -> None:
        distance, height = self._bed.T
        axes.fill_between(distance, self.extent[2], height, color=COLOUR, linewidth=0, zorder=0)

    def name(self, axes: Axes, stray: str) -> None:
        axes.set_title(f"from beside its way{stray}", **SMALL)
        axes.set(xlabel="along the way (m)", ylabel="z (m)")


def _name_plan(panels: Sequence[Axes], view: View, time: str) -> None:
    prime = "'" if view.rotate else ""
    panels[0].set_title(time, **SMALL)
    panels[0].set_axis_off()
    scale_bar(panels[0])
    panels[1].set_title("plan", **SMALL)
    panels[1].set(xlabel=f"x{prime} (m)", ylabel="y (m)")
