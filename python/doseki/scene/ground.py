"""The surface of a terrain, as the core has it during the run."""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np

from ..compiled import HeightField, load_core
from ..geodata.outlines import Polygon
from ..scenario.bed import TILE_COLUMNS, Bed

LEAST_HEIGHT = 0.25  # spacings above a bed; what rests on it lies at a half


class Ground:
    """The surface of a bed, and layers that follow it."""

    def __init__(self, bed: Bed) -> None:
        self.bed = bed
        self.dim = bed.heights.ndim + 1

    @cached_property
    def field(self) -> HeightField:
        """Heights and normals anywhere."""
        core = load_core()
        make = core.HeightField2 if self.dim == 2 else core.HeightField3
        return make(self.bed.table)

    def layer(
        self, low: np.ndarray, high: np.ndarray, dp: float, height: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Places (N, dim - 1) below the parts of a layer over a box in plan, m, and their areas.

        The layer is so high above the surface, m; an area (N,) is near dp^2, m2 (2-D: dp, m).
        """
        side = TILE_COLUMNS[self.dim] * dp
        first, last = np.floor(low / side), np.floor(high / side)
        ranges = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
        corners = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, self.dim - 1)
        found = [self.tile((side * corner).tolist(), side, dp, height) for corner in corners]
        place = np.concatenate([each[0] for each in found])
        area = np.concatenate([each[1] for each in found])
        inside = ((place >= low) & (place <= high)).all(axis=1)
        return place[inside], area[inside]

    def tile(
        self, low: list[float], side: float, dp: float, height: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """The same over one square, whose parts fill it."""
        found = self.field.layer(low, side, dp, -height)
        return found["place"], found["area"]

    def hollowness(self, place: np.ndarray, step: float) -> np.ndarray:
        """Curvature (N,) of the surface at places, 1/m: above 0 in hollows, from normals `step` m
        apart.
        """
        sum_of = np.zeros(len(place))
        for axis in range(self.dim - 1):
            shift = np.zeros(self.dim - 1)
            shift[axis] = 0.5 * step
            ahead, behind = (
                self.field.at(np.ascontiguousarray(place + s))["normal"][:, axis]
                for s in (shift, -shift)
            )
            sum_of -= (ahead - behind) / step
        return sum_of

    def area_in(self, polygon: Polygon) -> float:
        """The area of the surface over a polygon, m2: that in plan times the mean steepness."""
        place, area = polygon.quadrature()
        steepness = self.field.at(np.ascontiguousarray(place))["area"]
        return polygon.area * float(np.average(steepness, weights=area))

    def height_above(self, points: np.ndarray) -> np.ndarray:
        """Distance (N,) of points (N, dim) from the surface, m; below 0 in the ground."""
        return self.field.nearest(np.ascontiguousarray(points))["distance"]

    def above(self, place: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Points (N, dim), m, at a height (N,) along the normal above places (N, dim - 1)."""
        surface = self.field.at(np.ascontiguousarray(place))
        foot = np.column_stack([place, surface["height"]])
        return np.asarray(foot + height[:, None] * surface["normal"])


def beyond_text(place: np.ndarray) -> str:
    """What is said of a place (dim - 1,), m, of which the map says nothing."""
    at = np.round(place, 3).tolist()
    return f"reaches beyond the terrain, or where it has no data, as at {at} m"


@lru_cache(maxsize=2)
def ground_of(bed: Bed) -> Ground:
    """The ground of a bed, made once."""
    return Ground(bed)
