"""Meshes of triangles: what they enclose, convex or not, or sheets.  Lengths in m."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...compiled import SurfaceMesh, load_core
from .mesh_edges import edge_points
from .particles import EDGE


class Triangles(NamedTuple):
    """A mesh: corners that triangles share are one vertex, and all of them have an area."""

    vertices: np.ndarray  # (n, 3) m
    faces: np.ndarray  # (m, 3) int64, anticlockwise as seen from outside

    @property
    def corners(self) -> np.ndarray:
        """The corners (m, 3, 3) of each."""
        return np.asarray(self.vertices[self.faces])

    @property
    def areas(self) -> np.ndarray:
        """Normal of each times its area (m, 3), m2."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return np.asarray(0.5 * np.cross(b - a, c - a))


def core_mesh(mesh: Triangles, thickness: float) -> SurfaceMesh:
    """The mesh as the core searches it; a thickness above 0, m, is that of a sheet."""
    corners = np.ascontiguousarray(mesh.corners.reshape(-1, 3))
    return load_core().SurfaceMesh(corners, thickness)


@dataclass(frozen=True, eq=False)
class MeshShape:
    """A fixed surface about the middle of its extent: closed (thickness 0), or a sheet."""

    mesh: Triangles
    thickness: float  # of a sheet, m; 0: closed

    @cached_property
    def searched(self) -> SurfaceMesh:
        """The mesh as the core searches it."""
        return core_mesh(self.mesh, self.thickness)

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return 3

    @cached_property
    def area(self) -> float:
        """Of the surface, m2; of a sheet on both of its sides."""
        one = float(np.linalg.norm(self.mesh.areas, axis=1).sum())
        return 2 * one if self.thickness else one

    @cached_property
    def measure(self) -> float:
        """Volume, m3."""
        if self.thickness:
            return 0.5 * self.area * self.thickness
        return float(abs(np.linalg.det(self.mesh.corners).sum() / 6))

    @property
    def wet_measure(self) -> float:
        """Volume that fluid cannot enter."""
        return self.measure

    @property
    def inertia(self) -> np.ndarray:
        """Over the mass, m2: of a thing that never turns by itself, that of a ball around it."""
        return 0.4 * self.reach**2 * np.eye(3)

    @property
    def width(self) -> float:
        """Smallest extent along the axes."""
        return float(np.ptp(self.mesh.vertices, axis=0).min()) + self.thickness

    @property
    def reach(self) -> float:
        """Radius of the ball around it."""
        return float(np.linalg.norm(self.mesh.vertices, axis=1).max()) + 0.5 * self.thickness

    def wall(self, position: np.ndarray, dp: float) -> tuple[np.ndarray, np.ndarray]:
        """Outward normals (N, 3), means beside edges, and depths (N,) below the surface."""
        found = self.searched.from_wall(np.ascontiguousarray(position), EDGE * dp)
        return np.ascontiguousarray(found[:, 1:]), -found[:, 0]

    def contains(self, position: np.ndarray) -> np.ndarray:
        """Whether positions (N, 3) lie inside: the mesh winds around them."""
        position = np.ascontiguousarray(position)
        if self.thickness:
            return np.asarray(self.searched.from_wall(position, 1.0)[:, 0] < 0)
        return np.asarray(self.searched.winding(position) != 0)

    def samples(self, dp: float) -> np.ndarray:
        """Points of the edges that stick out, with which a convex body may touch it."""
        return edge_points(self.mesh.vertices, self.mesh.faces, self.thickness, dp)

    def table(self, dp: float) -> dict[str, Any]:
        """The shape as the core reads it."""
        return {
            "vertices": np.ascontiguousarray(self.mesh.vertices),
            "faces": np.ascontiguousarray(self.mesh.faces, np.int32),
            "samples": np.ascontiguousarray(self.samples(dp)),
            "thickness": np.array([self.thickness]),
        }
