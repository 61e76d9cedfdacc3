"""Pictures of runs in space: the whole in a slanting view, in plan, and in a long section."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...measure.moments import Moment
from ...measure.views import View, flow_direction, fluid_names
from ...record.reader import Run, Snapshot
from ..colouring import Colouring, colouring
from ..dots import ROOM, dots, draw_particles, ends_of_most, extent_of, grain_radius, outside_text
from ..layout import SMALL, Extent, ViewRows, moment_text, name_axes, scale_bar
from ..surfaces import Balls, Camera, render
from .panels import Panels

SLANTING = np.array([0.45, 0.80, -0.42])  # away from the viewer, where the flow runs to -x
DOWN = np.array([0.0, 0.0, -1.0])
HIDES = 0.2  # a wall hides what is behind it where it is turned so much towards the viewer
PIXELS = 640  # across a picture
ROUND = ("disc", "sphere")


@dataclass(frozen=True)
class Space:
    """What of the space is drawn: a box around what moves, corners (3,), and walls near it."""

    view: View
    low: np.ndarray
    high: np.ndarray

    @classmethod
    def around(cls, snapshots: Sequence[Snapshot], view: View) -> Space:
        """The box around what moves at some moments, within the view."""
        ends = []
        for snapshot in snapshots:
            position = view.coordinates(snapshot["position"])
            moves = ~snapshot["fixed"] & view.contains(snapshot["position"])
            ends.append(ends_of_most(position[moves] if moves.any() else position))
        low, high = np.min([e[0] for e in ends], axis=0), np.max([e[1] for e in ends], axis=0)
        return cls(view, np.maximum(low, view.lower), np.minimum(high, view.upper))

    def is_near(self, position: np.ndarray) -> np.ndarray:
        """Mask (N,) of what is in the box, or not far from it."""
        room = ROOM * float(np.max(self.high - self.low))
        inside: np.ndarray = (position > self.low - room) & (position < self.high + room)
        return np.all(inside, axis=1)

    def shows(self, snapshot: Snapshot, position: np.ndarray, away: np.ndarray) -> np.ndarray:
        """Mask (N,) of what is drawn: walls near what moves, but none between it and the viewer."""
        shown = self.view.contains(snapshot["position"])
        shown &= ~snapshot["fixed"] | self.is_near(position)
        before = np.zeros(len(position), bool)
        for axis, towards in enumerate(away):
            if abs(towards) > HIDES:
                end = self.low[axis] if towards > 0 else self.high[axis]
                before |= np.sign(towards) * (position[:, axis] - end) < 0
        return shown & ~(before & snapshot["fixed"])


def draw_spatial(run: Run, moments: Sequence[Moment], what: Panels) -> Figure:
    """For each moment and colour a slanting view, and a plan and a long section side by side."""
    snapshots = [run[moment.index] for moment in moments]
    space = Space.around(snapshots, what.view)
    away = SLANTING * [-(flow_direction(run) or 1), 1, 1]
    cameras = [Camera.looking(away), Camera.looking(DOWN)]
    extents = [_extent(space, snapshots, camera) for camera in cameras]
    extents.append(extent_of(snapshots, what.view))
    rows = list(product(zip(moments, snapshots, strict=True), what.colours))
    grid = ViewRows(len(rows), extents, what.title)
    colours = {name: colouring(run, snapshots, name, what.view) for name in what.colours}
    for row, ((moment, snapshot), name) in enumerate(rows):
        panels = grid.row(row)
        for camera, extent, axes in zip(cameras, extents, panels, strict=False):
            balls = _balls(run, snapshot, colours[name], space, camera, what)
            axes.imshow(render(balls, camera, extent, PIXELS), extent=extent)
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


def _balls(
    run: Run, snapshot: Snapshot, colours: Colouring, space: Space, camera: Camera, what: Panels
) -> Balls:
    position = space.view.coordinates(snapshot["position"])
    shown = space.shows(snapshot, position, camera.away)
    if what.material is not None:
        shown &= snapshot["material"] == what.material
    free = ~snapshot["fixed"]
    clear = np.isin(snapshot["material"], sorted(fluid_names(run))) & free
    radius, grain = grain_radius(snapshot), snapshot["grain"]
    alone = free & ~clear & (grain < 0)
    # A round grain is one ball, in place of the first of its particles.
    first = _first_of_each(grain, _is_round(run, snapshot))
    if len(first):
        table = snapshot.grains
        position[first] = space.view.coordinates(table["position"])[grain[first]]
        radius[first] = 0.5 * table["diameter"][grain[first]]
        shown &= ~_is_round(run, snapshot)[grain] | (grain < 0)
        shown[first] = space.shows(snapshot, position, camera.away)[first]
        alone[first] = True
    rgba = colours.rgba(snapshot)
    return Balls(
        position[shown], radius[shown], rgba[shown, :3], ~alone[shown], clear[shown]
    )  # fmt: skip


def _is_round(run: Run, snapshot: Snapshot) -> np.ndarray:
    """Which of the bodies that move are balls (n,), and of none in the end for grain -1."""
    tables = run.scenario.get("body", {})
    names = snapshot.grains.get("body", np.zeros(0, str))
    round_ones = [tables.get(str(name), {}).get("shape") in ROUND for name in names]
    return np.array([*round_ones, False])


def _first_of_each(grain: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Index of the first particle of each body that is `chosen`; the last of them is none."""
    bodies, first = np.unique(grain, return_index=True)
    return first[(bodies >= 0) & chosen[bodies]]


def _extent(space: Space, snapshots: Sequence[Snapshot], camera: Camera) -> Extent:
    """What holds all that is drawn, as the camera sees it."""
    low, high = [], []
    for snapshot in snapshots:
        position = space.view.coordinates(snapshot["position"])
        shown = space.shows(snapshot, position, camera.away) & space.is_near(position)
        points = camera.project(position[shown])
        low.append(points.min(axis=0))
        high.append(points.max(axis=0))
    first, last = np.min(low, axis=0), np.max(high, axis=0)
    margin = 0.03 * float(np.max(last - first))
    return first[0] - margin, last[0] + margin, first[1] - margin, last[1] + margin
