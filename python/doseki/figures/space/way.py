"""Which way a flow over a terrain goes, and how it looks from there and from beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geodata.raster import Raster
from ...record.reader import Run, Snapshot
from ..dots import MARGIN, Dots, drawing_order, ends_of_clouds, grain_radius
from ..layout import Extent
from ..nothing import NothingToDrawError
from .box import Space
from .surfaces import Camera

AGAINST, ACROSS, DOWN = 0.75, 0.40, 0.62  # how far one looks against the flow, across it, and down


@dataclass(frozen=True)
class Way:
    """Where the middle of a flow starts in plan (2,), m, and its direction (2,)."""

    start: np.ndarray
    direction: np.ndarray

    @classmethod
    def between(cls, snapshots: Sequence[Snapshot]) -> Way | None:
        """From the first moment at which something can move to the last; None without a way."""
        moving = [snapshot for snapshot in snapshots if (~snapshot["fixed"]).any()]
        if not moving:
            return None
        ends = moving[0], moving[-1]
        first, last = (end["position"][~end["fixed"], :2].mean(axis=0) for end in ends)
        length = float(np.linalg.norm(last - first))
        size = 2 * max(grain_radius(end).max() for end in ends)
        return cls(first, (last - first) / length) if length > size else None

    def looking_back(self) -> Camera:
        """The camera that stands in front of the flow, above it and somewhat beside it."""
        x, y = self.direction
        return Camera.looking(
            np.array([-AGAINST * x + ACROSS * y, -AGAINST * y - ACROSS * x, -DOWN])
        )

    def points(self, position: np.ndarray) -> np.ndarray:
        """How far along the way, and how high, positions (n, 3) are: (n, 2)."""
        return np.column_stack([(position[:, :2] - self.start) @ self.direction, position[:, 2]])


def dots_beside(snapshot: Snapshot, way: Way, space: Space, material: str | None) -> Dots:
    """All that moves and structures near it, seen from beside the way: structures first."""
    index = drawing_order(snapshot, _near(snapshot, space), material)
    return Dots(index, way.points(snapshot["position"][index]), grain_radius(snapshot)[index])


def _near(snapshot: Snapshot, space: Space) -> np.ndarray:
    """Mask (N,) of what moves, and of structures near it, in the view."""
    position = snapshot["position"]
    near: np.ndarray = space.view.contains(position) & (snapshot["body"] != space.buried)
    return near & (~snapshot["fixed"] | space.is_near(space.view.coordinates(position)))


def extent_beside(clouds: Sequence[Dots]) -> Extent:
    """What holds all dots but drops that fly far from all others.

    Raises NothingToDrawError where there is none.
    """
    clouds = [cloud for cloud in clouds if len(cloud.index)]
    if not clouds:
        raise NothingToDrawError("there is nothing to see")
    low, high = ends_of_clouds([cloud.points for cloud in clouds])
    largest = max(float(cloud.radius.max()) for cloud in clouds)
    margin = MARGIN * float(np.max(high - low)) + largest
    return low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin


def bed_beside(
    run: Run, way: Way, snapshots: Sequence[Snapshot], space: Space, ends: tuple[float, float]
) -> np.ndarray:
    """Where the ground below flow and structures is lowest: distance and height (n, 2), m.

    It goes on to both `ends`, m, along the way, beside what is drawn there.
    """
    ground = run.ground
    assert isinstance(ground, Raster)
    cell = 2 * max(float(grain_radius(s).max()) for s in snapshots)
    first = int(np.floor(ends[0] / cell))
    lowest = np.full(int(np.floor(ends[1] / cell)) - first + 1, np.inf)
    for place in _places_beside(way, snapshots, space, ends, cell):
        height = ground.sampled(place[:, 0], place[:, 1])
        number = np.floor((place - way.start) @ way.direction / cell).astype(int) - first
        known = ~np.isnan(height) & (number >= 0) & (number < len(lowest))
        known[known] &= np.isinf(lowest[number[known]])
        np.minimum.at(lowest, number[known], height[known])
    middle = (first + np.arange(len(lowest)) + 0.5) * cell
    return np.column_stack([middle, lowest])[np.isfinite(lowest)]


def _places_beside(
    way: Way, snapshots: Sequence[Snapshot], space: Space, ends: tuple[float, float], cell: float
) -> list[np.ndarray]:
    """Places (n, 2) over which the ground is drawn; those that come first have precedence.

    Below the flow; below structures, and beside their corners; and as far as both ends.
    """
    flow, walls = (
        np.concatenate([s["position"][_near(s, space) & (s["fixed"] == f), :2] for s in snapshots])
        for f in (False, True)
    )
    corners = np.concatenate([walls + k * cell * way.direction for k in range(-2, 3)])
    drawn = np.concatenate([flow, walls])
    along = (drawn - way.start) @ way.direction
    gaps = ends[0] - along.min(), ends[1] - along.max()
    return [flow, corners, *(drawn + gap * way.direction for gap in gaps)]
