"""Pictures of runs in space: the whole in a slanting view, in plan, and in a long section."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...measure.moments import Moment
from ...measure.views import View, flow_direction
from ...record.reader import Run
from ..colouring import colouring
from ..dots import dots, draw_particles, extent_of, outside_text
from ..layout import SMALL, ViewRows, moment_text, name_axes, scale_bar
from ..space.box import Space, balls_of, seen_extent
from ..space.ground import ground_balls, relief, terrain_of
from ..space.surfaces import Camera, joined, no_balls, render
from .panels import Panels

SLANTING = np.array([0.45, 0.80, -0.42])  # away from the viewer, where the flow runs to -x
DOWN = np.array([0.0, 0.0, -1.0])
PIXELS = 640  # across a picture


def draw_spatial(run: Run, moments: Sequence[Moment], what: Panels) -> Figure:
    """For each moment and colour a slanting view, and a plan and a long section side by side."""
    snapshots = [run[moment.index] for moment in moments]
    space = Space.around(snapshots, what.view, terrain_of(run))
    away = SLANTING * [-(flow_direction(run) or 1), 1, 1]
    cameras = [Camera.looking(away), Camera.looking(DOWN)]
    extents = [seen_extent(space, snapshots, camera) for camera in cameras]
    extents.append(extent_of(snapshots, what.view))
    reliefs = [None, None if what.view.rotate else relief(run, extents[1], PIXELS)]
    ground = ground_balls(run, space)
    grounds = [ground if picture is None else no_balls() for picture in reliefs]
    rows = list(product(zip(moments, snapshots, strict=True), what.colours))
    grid = ViewRows(len(rows), extents, what.title)
    colours = {name: colouring(run, snapshots, name, what.view) for name in what.colours}
    for row, ((moment, snapshot), name) in enumerate(rows):
        panels = grid.row(row)
        for k, (camera, extent, axes) in enumerate(zip(cameras, extents, panels, strict=False)):
            balls = balls_of(run, snapshot, colours[name], space, camera, what.material)
            seen = render(joined(balls, grounds[k]), camera, extent, PIXELS, reliefs[k])
            axes.imshow(seen, extent=extent)
            axes.set(xlim=extent[:2], ylim=extent[2:])
        shown = dots(snapshot, what.view, "grain", what.material)
        draw_particles(panels[2], snapshot, shown, colours[name], extents[2])
        stray = outside_text(snapshot, what.view, shown, extents[2])
        _name(panels, what.view, moment_text(run, moment), stray)
        if row < len(what.colours):
            colours[name].add_key(grid, panels[grid.key_beside])
    return grid.figure


def _name(panels: Sequence[Axes], view: View, time: str, stray: str) -> None:
    prime = "'" if view.rotate else ""
    panels[0].set_title(time, **SMALL)
    panels[0].set_axis_off()
    scale_bar(panels[0])
    panels[1].set_title("plan", **SMALL)
    panels[1].set(xlabel=f"x{prime} (m)", ylabel="y (m)")
    panels[2].set_title(f"long section{stray}", **SMALL)
    name_axes(panels[2], 3, view.rotate)
