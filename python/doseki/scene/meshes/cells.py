"""The cells into which a 2-D body is divided by its points and outline: cracks run through them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
from scipy.spatial import Delaunay

ALIKE = 1e-6  # spacings between circumcentres of triangles that are parts of one cell
FLAT = 1e-6  # square spacings: triangles of less area lie along a side


@dataclass(frozen=True)
class Cells:
    """Polygons; `node` holds the corners of one after another, anticlockwise.

    Corners are the points of a body by their index, then the vertices of its outline.
    """

    count: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint32))  # corners of each
    node: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint32))


def cells_of(points: np.ndarray, outline: np.ndarray, spacing: float) -> Cells | None:
    """Those of points (n, 2), m, in a convex outline (m, 2), anticlockwise, m.

    Delaunay's triangles, those on one circle together: squares of a lattice are whole, and the
    mirror image of a body has the mirror images of its cells.  None where the outline is not the
    border of the triangles.
    """
    places = np.concatenate([points, outline]) / spacing
    places -= places.mean(axis=0)
    triangles = Delaunay(places).simplices
    triangles = _anticlockwise(triangles, places)
    cells = list(_merged(triangles, places))
    sides = {side for cell in cells for side in _sides(cell)}
    vertices = list(range(len(points), len(places)))
    if {(a, b) for a, b in sides if (b, a) not in sides} != set(_sides(vertices)):
        return None
    count = np.array([len(cell) for cell in cells], np.uint32)
    return Cells(count, np.fromiter(chain.from_iterable(cells), np.uint32))


def _sides(corners: list[int]) -> Iterator[tuple[int, int]]:
    return zip(corners, corners[1:] + corners[:1], strict=True)


def _anticlockwise(triangles: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Triangles that have an area."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    turned = np.where((area < 0)[:, None], triangles[:, ::-1], triangles)
    return turned[np.abs(area) > FLAT]


def _merged(triangles: np.ndarray, places: np.ndarray) -> Iterator[list[int]]:
    """Polygons of the triangles with the same circumcentre, each around its middle."""
    centre: list[list[float]] = _circumcentres(places[triangles]).tolist()
    across: dict[tuple[int, int], int] = {}
    group = list(range(len(triangles)))

    def root(k: int) -> int:
        while group[k] != k:
            k = group[k]
        return k

    for k, corners in enumerate(triangles.tolist()):
        for side in _sides(corners):
            other = across.get(side[::-1])
            if other is not None and _apart(centre[k], centre[other]) < ALIKE:
                group[root(k)] = root(other)
            across[side] = k
    members: dict[int, set[int]] = {}
    for k, corners in enumerate(triangles.tolist()):
        members.setdefault(root(k), set()).update(corners)
    where: list[list[float]] = places.tolist()
    for own in members.values():
        yield _around_their_middle(sorted(own), where)


def _apart(a: list[float], b: list[float]) -> float:
    """Along the axis along which they are farther apart."""
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]))


def _around_their_middle(corners: list[int], where: list[list[float]]) -> list[int]:
    """Anticlockwise."""
    x = sum(where[k][0] for k in corners) / len(corners)
    y = sum(where[k][1] for k in corners) / len(corners)
    return sorted(corners, key=lambda k: math.atan2(where[k][1] - y, where[k][0] - x))


def _circumcentres(corners: np.ndarray) -> np.ndarray:
    """Of triangles (n, 3, 2)."""
    b, c = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = 2 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    bb, cc = (b**2).sum(axis=1), (c**2).sum(axis=1)
    x = (c[:, 1] * bb - b[:, 1] * cc) / double
    y = (b[:, 0] * cc - c[:, 0] * bb) / double
    return corners[:, 0] + np.stack([x, y], axis=1)
