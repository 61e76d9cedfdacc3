"""Vertices of the smooth surfaces with which deformable bodies touch in space.  Lengths in m."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ..lattices import ROUNDING

PARTS = 4  # vertices from one particle to the next


class SurfaceVertices(NamedTuple):
    """Places on a surface, each with the outward normal there and the area for which it stands."""

    place: np.ndarray  # (n, 3) m
    normal: np.ndarray  # (n, 3)
    area: np.ndarray  # (n,) m2; the areas add up to that of the surface


def on_sphere(
    radius: float, directions: tuple[np.ndarray, np.ndarray], dp: float
) -> SurfaceVertices:
    """At unit vectors (n, 3), each with its share (n,) of all directions."""
    unit, share = directions
    area = share * (4 * np.pi * radius**2)
    return _near_each_other(SurfaceVertices(radius * unit, unit, area), dp)


def on_triangles(corners: np.ndarray, dp: float) -> SurfaceVertices:
    """In the middles of alike parts of each of the triangles (m, 3, 3), outwards."""
    places, normals, areas = [], [], []
    for a, b, c in corners:
        across = 0.5 * np.cross(b - a, c - a)
        area = float(np.linalg.norm(across))
        longest = max(float(np.linalg.norm(side)) for side in (b - a, c - b, a - c))
        parts = max(int(np.ceil(PARTS * longest / dp / np.sqrt(2) * (1 - 1e-9))), 1)
        i, j = _parts(parts)
        places.append(a + i[:, None] * (b - a) + j[:, None] * (c - a))
        normals.append(np.tile(across / area, (len(i), 1)))
        areas.append(np.full(len(i), area / len(i)))
    vertices = SurfaceVertices(*map(np.concatenate, (places, normals, areas)))
    return _near_each_other(vertices, dp)


def shared_among(
    particles: np.ndarray, vertices: SurfaceVertices
) -> tuple[SurfaceVertices, np.ndarray]:
    """The vertices, and the particle (n,) nearest to each, around which it turns.

    One as near to several is as many, each with its part of the area: else it would depend on the
    order of the particles around which of them it turns.
    """
    tree = cKDTree(particles)
    reach = (1 + ROUNDING) * tree.query(vertices.place)[0]
    nearest = tree.query_ball_point(vertices.place, reach, return_sorted=True)
    parts = np.array([len(near) for near in nearest])
    place, normal, area = (np.repeat(column, parts, axis=0) for column in vertices)
    area = area / np.repeat(parts, parts)
    return SurfaceVertices(place, normal, area), np.concatenate(nearest).astype(int)


def _parts(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Middles of the parts of a triangle with each side in so many, along two of its sides."""
    i, j = np.meshgrid(np.arange(number), np.arange(number), indexing="ij")
    upright, turned = i + j < number, i + j < number - 1
    along = np.concatenate([i[upright] + 1 / 3, i[turned] + 2 / 3])
    across = np.concatenate([j[upright] + 1 / 3, j[turned] + 2 / 3])
    return along / number, across / number


def _near_each_other(vertices: SurfaceVertices, dp: float) -> SurfaceVertices:
    """The same in an order in which those that follow each other are near: cell by cell."""
    cell = np.floor(vertices.place / (2 * dp))
    order = np.lexsort(cell.T)
    return SurfaceVertices(*(column[order] for column in vertices))
