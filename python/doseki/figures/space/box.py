"""What of a 3-D run is drawn, as a camera sees it: grains, structures and water as balls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geodata.raster import Raster
from ...measure.census.grains import keep_their_shape
from ...measure.views import View, fluid_names
from ...record.reader import Run, Snapshot
from ..colouring import Colouring
from ..dots import ROOM, ends_of_clouds, grain_radius
from ..layout import Extent
from ..nothing import NothingToDrawError
from .surfaces import Balls, Camera

HIDES = 0.2  # a wall hides what is behind it where it is turned so much towards the viewer
ROUND = ("disc", "sphere")


@dataclass(frozen=True)
class Space:
    """What of the space is drawn: a box around what moves, corners (3,), and walls near it.

    Particles of the body `buried` are not: those of a terrain, which is drawn itself; nor is what
    is fixed below its `ground`.
    """

    view: View
    low: np.ndarray
    high: np.ndarray
    buried: str | None = None
    ground: Raster | None = None

    @classmethod
    def around(
        cls,
        snapshots: Sequence[Snapshot],
        view: View,
        buried: str | None = None,
        ground: Raster | None = None,
    ) -> Space:
        """The box around what moves at some moments, within the view.

        Raises NothingToDrawError where there is no particle at any of them.
        """
        clouds = []
        for snapshot in (each for each in snapshots if len(each["id"])):
            position = view.coordinates(snapshot["position"])
            moves = ~snapshot["fixed"] & view.contains(snapshot["position"])
            clouds.append(position[moves] if moves.any() else position)
        if not clouds:
            raise NothingToDrawError("there are no particles")
        low, high = ends_of_clouds(clouds)
        return cls(view, np.maximum(low, view.lower), np.minimum(high, view.upper), buried, ground)

    def is_near(self, position: np.ndarray) -> np.ndarray:
        """Mask (N,) of what is in the box, or not far from it."""
        room = ROOM * float(np.max(self.high - self.low))
        inside: np.ndarray = (position > self.low - room) & (position < self.high + room)
        return np.all(inside, axis=1)

    def shows(self, snapshot: Snapshot, position: np.ndarray, away: np.ndarray) -> np.ndarray:
        """Mask (N,) of what is drawn: walls near what moves, but none between it and the viewer.

        On a terrain, which is no box, these are drawn, too: the dam that a flow meets is one.
        """
        shown = self.view.contains(snapshot["position"])
        shown &= ~snapshot["fixed"] | self.is_near(position)
        if self.buried is not None:
            return shown & (snapshot["body"] != self.buried) & ~self._in_the_ground(snapshot)
        before = np.zeros(len(position), bool)
        for axis, towards in enumerate(away):
            if abs(towards) > HIDES:
                end = self.low[axis] if towards > 0 else self.high[axis]
                before |= np.sign(towards) * (position[:, axis] - end) < 0
        return shown & ~(before & snapshot["fixed"])

    def _in_the_ground(self, snapshot: Snapshot) -> np.ndarray:
        """Mask (N,) of what is fixed below the ground, but for a layer that the ground hides."""
        below = snapshot["fixed"].copy()
        if self.ground is None:
            return np.zeros_like(below)
        x, y, z = snapshot["position"][below].T
        below[below] = z + 2 * grain_radius(snapshot)[below] < self.ground.sampled(x, y)
        return below


def balls_of(
    run: Run,
    snapshot: Snapshot,
    colours: Colouring,
    space: Space,
    camera: Camera,
    material: str | None = None,
) -> Balls:
    """What is drawn of a snapshot, of one material where it is given: a round grain is one ball."""
    position = space.view.coordinates(snapshot["position"])
    shown = space.shows(snapshot, position, camera.away)
    if material is not None:
        shown &= snapshot["material"] == material
    free = ~snapshot["fixed"]
    clear = np.isin(snapshot["material"], sorted(fluid_names(run))) & free
    radius, grain = grain_radius(snapshot), snapshot["grain"]
    alone = free & ~clear & (grain < 0)
    # A round grain is one ball, in place of the first of its particles.
    first = _first_of_each(grain, is_round(run, snapshot))
    if len(first):
        table = snapshot.grains
        position[first] = space.view.coordinates(table["position"])[grain[first]]
        radius[first] = 0.5 * table["diameter"][grain[first]]
        shown &= ~is_round(run, snapshot)[grain] | (grain < 0)
        shown[first] = space.shows(snapshot, position, camera.away)[first]
        alone[first] = True
    rgba = colours.rgba(snapshot)
    return Balls(
        position[shown], radius[shown], rgba[shown, :3], ~alone[shown], clear[shown]
    )  # fmt: skip


def is_round(run: Run, snapshot: Snapshot) -> np.ndarray:
    """Which of the bodies that move are balls (n,), and of none in the end for grain -1."""
    tables = run.scenario.get("body", {})
    names = snapshot.grains.get("body", np.zeros(0, str))
    round_ones = [tables.get(str(name), {}).get("shape") in ROUND for name in names]
    return np.append(np.array(round_ones, bool) & keep_their_shape(run, snapshot), False)


def _first_of_each(grain: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Index of the first particle of each body that is `chosen`; the last of them is none."""
    bodies, first = np.unique(grain, return_index=True)
    return first[(bodies >= 0) & chosen[bodies]]


def seen_extent(space: Space, snapshots: Sequence[Snapshot], camera: Camera) -> Extent:
    """What holds all that is drawn, as the camera sees it."""
    low, high = [], []
    for snapshot in snapshots:
        position = space.view.coordinates(snapshot["position"])
        shown = space.shows(snapshot, position, camera.away) & space.is_near(position)
        if not shown.any():
            continue
        points = camera.project(position[shown])
        low.append(points.min(axis=0))
        high.append(points.max(axis=0))
    if not low:
        raise NothingToDrawError("there is nothing to see")
    first, last = np.min(low, axis=0), np.max(high, axis=0)
    margin = 0.03 * float(np.max(last - first))
    return first[0] - margin, last[0] + margin, first[1] - margin, last[1] + margin
