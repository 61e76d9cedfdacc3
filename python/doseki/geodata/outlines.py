"""Polygons and lines of a map with their attributes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .inside import inside_rings, ring_area

SAMPLES = 200  # along each side of a box
FLAT = 1e-9  # of the square of its diagonal, an area that is none


@dataclass(frozen=True, eq=False)
class Polygon:
    """An area with holes.

    Attributes:
        outer: vertices (n, 2) of its outer ring, m; the first is not repeated at the end.
        holes: the same for each hole.
        attributes: what the file says of it: names, and numbers, texts, truths or None.
        source: the file and the number of the feature, for messages.

    """

    outer: np.ndarray
    holes: tuple[np.ndarray, ...] = ()
    attributes: Mapping[str, Any] = field(default_factory=dict)
    source: str = ""

    @property
    def rings(self) -> tuple[np.ndarray, ...]:
        """The outer ring, then the holes."""
        return (self.outer, *self.holes)

    @property
    def area(self) -> float:
        """Its area without holes, m2."""
        return abs(ring_area(self.outer)) - sum(abs(ring_area(hole)) for hole in self.holes)

    @property
    def has_area(self) -> bool:
        """Whether it is more than a line, which rounding of coordinates may give some area."""
        west, south, east, north = self.extent
        return self.area > FLAT * ((east - west) ** 2 + (north - south) ** 2)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """West, south, east, north, m."""
        (west, south), (east, north) = self.outer.min(axis=0), self.outer.max(axis=0)
        return float(west), float(south), float(east), float(north)

    def contains(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Which points of the map lie inside; arrays that broadcast.

        By the even-odd rule. Of polygons that share an edge, one has the points on it.
        """
        return inside_rings(self.rings, x, y)

    def quadrature(self) -> tuple[np.ndarray, np.ndarray]:
        """Places (n, 2) inside, along 200 lines to the east, and the area (n,) of each, m2."""
        west, south, east, north = self.extent
        wide, high = (east - west) / SAMPLES, (north - south) / SAMPLES
        places, areas = [], []
        for y in south + high * (np.arange(SAMPLES) + 0.5):
            for first, last in self._chords(y):
                count = int(np.ceil((last - first) / wide)) or 1
                step = (last - first) / count
                x = first + step * (np.arange(count) + 0.5)
                places.append(np.column_stack([x, np.full(count, y)]))
                areas.append(np.full(count, step * high))
        return np.concatenate(places), np.concatenate(areas)

    def _chords(self, y: float) -> np.ndarray:
        """Where a line to the east enters and leaves (n, 2), m."""
        start = np.concatenate(self.rings)
        end = np.concatenate([np.roll(ring, -1, axis=0) for ring in self.rings])
        meets = (start[:, 1] <= y) != (end[:, 1] <= y)
        start, along = start[meets], end[meets] - start[meets]
        crossing = start[:, 0] + along[:, 0] * (y - start[:, 1]) / along[:, 1]
        return np.sort(crossing).reshape(-1, 2)

    def shared_with(self, other: Polygon) -> float:
        """The area that also belongs to another one, m2, from 200 x 200 points of both extents."""
        low = np.maximum(self.extent[:2], other.extent[:2])
        size = np.minimum(self.extent[2:], other.extent[2:]) - low
        if (size <= 0).any():
            return 0.0
        places = _samples(low, size)
        both = self.contains(*places) & other.contains(*places)
        return float(size[0] * size[1] * both.mean())

    def share_within(self, other: Polygon) -> float:
        """The share of it that also belongs to another one, from 200 x 200 points."""
        low = np.array(self.extent[:2])
        places = _samples(low, self.extent[2:] - low)
        mine = self.contains(*places)
        return float(other.contains(*places)[mine].mean()) if mine.any() else 1.0


def _samples(low: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates x (n,) and y (n, 1) over a box, m."""
    steps = (np.arange(SAMPLES) + 0.5) / SAMPLES
    return low[0] + size[0] * steps, low[1] + size[1] * steps[:, None]


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points.

    Attributes:
        vertices: (n, 2), m.
        heights: (n,), m, where the file has them.
        attributes: what the file says of it.

    """

    vertices: np.ndarray
    heights: np.ndarray | None = None
    attributes: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Features:
    """What a file holds; parts of one feature are polygons or lines of equal attributes.

    `crs` is its coordinate reference system, as WKT or by a name such as "EPSG:32633"; None where
    the file does not tell, and then coordinates are those of the terrain.
    """

    polygons: tuple[Polygon, ...] = ()
    lines: tuple[Line, ...] = ()
    crs: str | None = None

    def contains(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Which points of the map lie in one of the polygons; arrays that broadcast."""
        x, y = np.broadcast_arrays(x, y)
        inside = np.zeros(x.shape, dtype=bool)
        for polygon in self.polygons:
            inside |= polygon.contains(x, y)
        return inside
