"""The surface of a terrain, as the core has it during the run."""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np

from ..compiled import HeightField, load_core
from ..scenario.bed import Bed

TILE = {2: 16, 3: 8}  # columns along one side of a tile


class Ground:
    """The surface of a bed: what stands on it stands on columns of equal area."""

    def __init__(self, bed: Bed) -> None:
        self.bed = bed
        self.dim = bed.heights.ndim + 1

    @cached_property
    def field(self) -> HeightField:
        """Heights and normals anywhere."""
        core = load_core()
        make = core.HeightField2 if self.dim == 2 else core.HeightField3
        return make(self.bed.table)

    def columns(
        self, low: np.ndarray, high: np.ndarray, dp: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Places (N, dim - 1) of columns over a box in plan, m, and the area of surface of each.

        An area is near dp^2, m2; in 2-D near dp, m.
        """
        side = TILE[self.dim] * dp
        first, last = np.floor(low / side), np.floor(high / side)
        ranges = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
        corners = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, self.dim - 1)
        found = [self.field.columns((side * corner).tolist(), side, dp) for corner in corners]
        place = np.concatenate([each["place"] for each in found])
        area = np.concatenate([each["area"] for each in found])
        inside = ((place >= low) & (place <= high)).all(axis=1)
        return place[inside], area[inside]

    def height_above(self, points: np.ndarray) -> np.ndarray:
        """Distance (N,) of points (N, dim) from the surface, m; below 0 in the ground."""
        return self.field.nearest(np.ascontiguousarray(points))["distance"]

    def above(self, place: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Points (N, dim), m, at a height (N,) along the normal above places (N, dim - 1)."""
        surface = self.field.at(np.ascontiguousarray(place))
        foot = np.column_stack([place, surface["height"]])
        return np.asarray(foot + height[:, None] * surface["normal"])


@lru_cache(maxsize=2)
def ground_of(bed: Bed) -> Ground:
    """The ground of a bed, made once."""
    return Ground(bed)
