"""Polygons and lines made of lists of coordinates, with what files may hold checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .errors import GeodataError
from .outlines import Line, Polygon

MAX_VERTICES = 10_000_000  # of one ring or line
LARGEST = 1e9  # m; the earth is 4e7 m around


def polygon_of(where: str, rings: Sequence[Any], attributes: Mapping[str, Any]) -> Polygon:
    """A polygon of rings of coordinates, the first of them the outer one."""
    if not rings:
        raise GeodataError(f"{where}: a polygon without vertices")
    outer, *holes = (_ring(where, ring) for ring in rings)
    return Polygon(outer, tuple(holes), attributes, where)


def line_of(where: str, coordinates: Any, attributes: Mapping[str, Any]) -> Line:
    """A line through coordinates of two numbers, or of three: the third is a height."""
    points = _points(where, coordinates)
    if len(points) < 2:
        raise GeodataError(f"{where}: a line needs two points")
    heights = points[:, 2].copy() if points.shape[1] > 2 else None
    return Line(points[:, :2].copy(), heights, attributes)


def _ring(where: str, coordinates: Any) -> np.ndarray:
    """The vertices (n, 2) of a ring, the first not repeated."""
    points = _points(where, coordinates)[:, :2]
    if len(points) > 1 and np.array_equal(points[0], points[-1]):
        points = points[:-1]
    if len(np.unique(points, axis=0)) < 3:
        raise GeodataError(f"{where}: a polygon needs three vertices that differ")
    return points.copy()


def _points(where: str, coordinates: Any) -> np.ndarray:
    """Coordinates (n, 2 or more) as finite numbers."""
    try:
        points = np.array(coordinates, dtype=object)
        numbers = points.ndim == 2 and all(type(v) in (int, float) for v in points.flat)
        points = points.astype(np.float64) if numbers else points
    except (ValueError, TypeError, OverflowError):
        numbers = False
    if not numbers or points.shape[1] not in (2, 3, 4):
        raise GeodataError(f"{where}: coordinates must be lists of two or three numbers")
    if len(points) > MAX_VERTICES:
        raise GeodataError(f"{where}: {len(points)} vertices; at most {MAX_VERTICES} are read")
    if not np.all(np.abs(points[:, :2]) < LARGEST):
        raise GeodataError(f"{where}: coordinates must be finite and below {LARGEST:g} m")
    return points
