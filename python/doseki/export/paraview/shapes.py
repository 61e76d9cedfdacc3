"""Shapes of bodies as polygons, where they stand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...scene.groups import matrices
from ...scene.shapes import Ball, Convex, MeshShape, Shape

AROUND = 48  # corners of a disc
MANY = 300  # balls: more of them have few triangles


@dataclass(frozen=True)
class Polygons:
    """Polygons of the same number of corners: `points` (n, dim) m, `faces` (m, corners)."""

    points: np.ndarray
    faces: np.ndarray


def polygons_of(shape: Shape | MeshShape, many: bool = False) -> Polygons:
    """The surface of a shape about its centre; in 2-D its outline, one polygon."""
    if isinstance(shape, Ball):
        return _disc(shape.radius) if shape.dim == 2 else _ball(shape.radius, 1 if many else 3)
    if isinstance(shape, Convex):
        if shape.dim == 2:
            return Polygons(shape.vertices, shape.faces[:, 0][None, _around(shape.faces)])
        return Polygons(shape.vertices, shape.faces)
    return Polygons(shape.mesh.vertices, shape.mesh.faces)


def placed(polygons: Polygons, centre: np.ndarray, orientation: np.ndarray) -> Polygons:
    """The same where a body is: its centre (dim,), m, and its orientation (4,), a quaternion."""
    turn = matrices(orientation[None], len(centre))[0]
    return Polygons(centre + polygons.points @ turn.T, polygons.faces)


def joined(parts: list[Polygons], dim: int) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """Points (n, dim), faces with as many corners as they have, and the part of each face."""
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    points = np.concatenate([np.zeros((0, dim)), *(part.points for part in parts)])
    faces = [row + at for part, at in zip(parts, first, strict=False) for row in part.faces]
    owner = np.repeat(np.arange(len(parts)), [len(part.faces) for part in parts])
    return points, faces, owner


def _around(segments: np.ndarray) -> np.ndarray:
    """The order in which segments (m, 2) follow one another around a polygon."""
    following = {int(start): k for k, (start, _) in enumerate(segments)}
    order = [0]
    while len(order) < len(segments):
        order.append(following[int(segments[order[-1], 1])])
    return np.array(order)


def _disc(radius: float) -> Polygons:
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    points = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Polygons(points, np.arange(AROUND)[None, :])


@lru_cache(maxsize=8)
def _unit_ball(subdivisions: int) -> Polygons:
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
    return Polygons(np.array(mesh.vertices), np.array(mesh.faces))


def _ball(radius: float, subdivisions: int) -> Polygons:
    unit = _unit_ball(subdivisions)
    return Polygons(radius * unit.points, unit.faces)
