"""Surfaces of triangles (3-D) and closed lines (2-D) through the blocks of a grid."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...errors import UserError
from .fraction import Block

ON_NODE = 1e-5  # cells: nearer to a node than a level is ever


@dataclass(frozen=True)
class Surface:
    """What bounds a region: `points` (n, dim), m.

    In 3-D `faces` are triangles (m, 3), anticlockwise as seen from outside; in 2-D segments (m, 2)
    with the inside on their left.
    """

    points: np.ndarray
    faces: np.ndarray

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return int(self.points.shape[1])

    @property
    def area(self) -> float:
        """Of the surface, m2; 2-D: the length of the line, m."""
        corners = self.points[self.faces]
        if self.dim == 2:
            return float(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1).sum())
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return 0.5 * float(np.linalg.norm(normal, axis=1).sum())

    @property
    def volume(self) -> float:
        """Inside, m3; 2-D: the area, m2."""
        if not len(self.points):
            return 0.0
        corners = self.points[self.faces] - self.points.mean(axis=0)
        return float(np.linalg.det(corners).sum()) / (2 if self.dim == 2 else 6)

    def loops(self) -> list[np.ndarray]:
        """In 2-D the closed lines: indices of points, the first again at the end."""
        following = dict(self.faces.tolist())
        loops = []
        while following:
            start, point = following.popitem()
            loop = [start, point]
            while point != start:
                point = following.pop(point)
                loop.append(point)
            loops.append(np.array(loop))
        return loops


def contour(blocks: Iterable[Block], cell: float, dim: int) -> Surface:
    """The surface of what is above zero, where blocks meet as if they were one grid.

    Raises UserError where scikit-image, which finds the triangles, is missing.
    """
    points, keys, faces, count = [np.zeros((0, dim))], [np.zeros((0, dim), np.int64)], [], 0
    for block in blocks:
        if not block.values.min() < 0 < block.values.max():
            continue
        places, corners = _triangles(block.values) if dim == 3 else _segments(block.values)
        keys.append(_keys(places) + 2 * block.first)
        points.append((block.first + places) * cell)
        faces.append(corners + count)
        count += len(places)
    joined = np.concatenate(faces) if faces else np.zeros((0, dim), np.int64)
    return _merged(np.concatenate(points), np.concatenate(keys), joined)


def _triangles(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, in cells, and triangles by Lewiner's marching cubes."""
    try:
        from skimage.measure import marching_cubes
    except ImportError:
        raise UserError(
            "surfaces need scikit-image; pip install 'doseki[surface]' adds it"
        ) from None
    places, faces, _, _ = marching_cubes(
        values.astype(np.float32), 0.0, gradient_direction="ascent"
    )
    return places.astype(float), faces.astype(np.int64)


def _segments(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, in cells, and segments by marching squares, the inside on their left."""
    from contourpy import LineType, contour_generator

    found = contour_generator(z=values, line_type=LineType.Separate).lines(0.0)
    places, faces, count = [np.zeros((0, 2))], [np.zeros((0, 2), np.int64)], 0
    for line in found:
        rows = np.asarray(line)[::-1, ::-1]  # its columns are ours the other way round
        number = count + np.arange(len(rows))
        places.append(rows)
        faces.append(np.stack([number[:-1], number[1:]], axis=1))
        count += len(rows)
    return np.concatenate(places), np.concatenate(faces)


def _keys(places: np.ndarray) -> np.ndarray:
    """What tells where on the grid a vertex is: even on a node's plane, odd between two."""
    nearest = np.rint(places)
    between = np.abs(places - nearest) > ON_NODE
    return np.where(between, 2 * np.floor(places) + 1, 2 * nearest).astype(np.int64)


def _merged(points: np.ndarray, keys: np.ndarray, faces: np.ndarray) -> Surface:
    """Vertices on the same edge of the grid as one."""
    if not len(points):
        return Surface(points, faces)
    away = keys - keys.min(axis=0)
    number = np.ravel_multi_index(tuple(away.T), tuple(away.max(axis=0) + 1))
    _, first, own = np.unique(number, return_index=True, return_inverse=True)
    return Surface(points[first], own.ravel()[faces])
