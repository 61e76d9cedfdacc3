"""Convex polygons and polyhedra."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .frame import own_frame
from .outline import BULGE, FLAT, Outline, outline_of
from .particles import EDGE, Curve, Particles, alike, beside_edges, nearest_faces, no_edges
from .spanned import spanned
from .surface import SurfaceVertices, on_triangles

SAME_DEPTH = 1e-6  # dp
LEAST_DEPTH = 0.25  # dp below its sides, of the points of a body that deforms
LEAST = 0.3  # of a particle's volume: particles that would have less are left out
AT_ONCE = 2**22  # distances from sides that are held at a time


@dataclass(frozen=True)
class Convex:
    """A convex polygon (faces: segments, anticlockwise) or polyhedron (triangles, outwards)."""

    vertices: np.ndarray  # (n, dim) about the centre of mass
    faces: np.ndarray  # (m, dim) int32
    measure: float
    inertia: np.ndarray  # (3, 3) over the mass, m2; 2-D: only [2, 2]

    @property
    def wet_measure(self) -> float:
        """Area or volume that fluid cannot enter."""
        return self.measure

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return self.vertices.shape[1]

    @cached_property
    def outline(self) -> Outline:
        """Its sides, edges and corners."""
        return outline_of(self.vertices, self.faces)

    @cached_property
    def axes(self) -> np.ndarray:
        """The shape's own axes, as columns of a matrix (dim, dim)."""
        return own_frame(self.outline.corners, self.outline.area, self.outline.middles)

    @property
    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Unit normals (m, dim) of the sides, outwards, and their distances from the centre."""
        return self.outline.normal, self.outline.distance

    @property
    def width(self) -> float:
        """Smallest extent across a face."""
        normal, distance = self.planes
        blocks = _blocks(len(normal), len(self.vertices))
        lowest = [(self.vertices @ normal[some].T).min(axis=0) for some in blocks]
        return float((distance - np.concatenate(lowest)).min())

    @property
    def bulge(self) -> float:
        """By how much, m, a vertex lies beyond a side: more than rounding if it is not convex."""
        normal, distance = self.planes
        blocks = _blocks(len(normal), len(self.vertices))
        return float(max((self.vertices @ normal[b].T - distance[b]).max() for b in blocks))

    @property
    def reach(self) -> float:
        """Radius of the circumscribed ball."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    def particles(self, dp: float) -> Particles:
        """Those of `filling`, with what there is to know of their sides."""
        return self.beneath(*self.filling(dp), dp)

    def filling(self, dp: float) -> tuple[np.ndarray, np.ndarray]:
        """Positions (N, dim), m, of the particles, and their shares (N,) of the measure.

        The innermost points of a lattice along its own axes, as many as fill the shape. Points of
        the same depth are all in or all out, and share what of the shape is left for them. The mean
        of all is the centre.
        """
        upright = self.outline.corners @ self.axes
        low, high = upright.min(axis=0), upright.max(axis=0)
        counts = np.maximum(np.rint(np.round((high - low) / dp, 6)), 1).astype(int)
        cell = (high - low) / counts
        steps = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
        lattice = (low + (steps.reshape(-1, self.dim) + 0.5) * cell) @ self.axes.T
        number = self.measure / float(np.prod(cell))
        share = _innermost(self._depth(lattice) / dp, number)
        position, share = lattice[share > 0], share[share > 0] / share.sum()
        return position - share @ position, share

    def elastic_particles(self, dp: float) -> Particles:
        """Those of a rigid body with equal shares, with the edges that they have while it is rigid.

        All lie inside: some of a rigid one may be outside by a part of dp.  In a sharp corner there
        are only those that others hold from more than one side.
        """
        position = spanned(self._drawn_in(self.filling(dp)[0], LEAST_DEPTH * dp), dp)
        share = alike(len(position))
        return self.beneath(position - share @ position, share, dp)

    def _drawn_in(self, position: np.ndarray, depth: float) -> np.ndarray:
        """The positions, those less deep than `depth`, m, moved to it, as far as corners let."""
        normals = self.planes[0]
        for _ in range(self.dim):
            gaps = self._gaps(position)
            nearest = gaps.argmin(axis=1)
            lack = np.maximum(depth - gaps.min(axis=1), 0.0)
            position = position - lack[:, None] * normals[nearest]
        return position

    def beneath(self, position: np.ndarray, share: np.ndarray, dp: float) -> Particles:
        """Particles at positions (N, dim), m, with what there is to know of their sides."""
        normal, depth = self.wall(position, dp)
        plane, edges = np.zeros(len(depth)), no_edges(*position.shape)
        for some in self._rows(position):
            found = beside_edges(self._gaps(position[some]), self.planes[0], EDGE * dp)
            edges.normals[some], edges.depths[some] = found
        return Particles(position, normal, depth, plane, share, edges)

    def curve(self, dp: float) -> Curve:
        """The corners of a polygon, and vertices above the middles of particles along its sides."""
        vertex, crease = [], []
        for start, end in self.vertices[self.faces]:
            parts = max(round(float(np.linalg.norm(end - start)) / dp), 1)
            share = np.concatenate([[0.0], (np.arange(parts) + 0.5) / parts])[:, None]
            vertex.append(start + share * (end - start))
            crease.append(np.arange(parts + 1) == 0)
        return Curve(np.concatenate(vertex), np.concatenate(crease))

    def surface(self, dp: float) -> SurfaceVertices:
        """What a deformable polyhedron touches with."""
        return on_triangles(self.vertices[self.faces], dp)

    def single(self) -> Particles:
        """One particle in the centre."""
        zero = np.zeros((1, self.dim))
        depth = self._gaps(zero).min(axis=1)
        none = no_edges(1, self.dim)
        return Particles(zero, zero.copy(), depth, np.zeros(1), np.ones(1), none)

    def wall(self, position: np.ndarray, dp: float) -> tuple[np.ndarray, np.ndarray]:
        """Outward normals (N, dim), means beside edges, and depths (N,) below the sides."""
        normal, depth = np.zeros(position.shape), np.zeros(len(position))
        for some in self._rows(position):
            found = nearest_faces(self._gaps(position[some]), self.planes[0], EDGE * dp)
            normal[some], depth[some] = found
        return normal, depth

    def contains(self, position: np.ndarray) -> np.ndarray:
        """Whether positions (N, dim) lie inside."""
        return self._depth(position) > FLAT * self.reach

    def _depth(self, position: np.ndarray) -> np.ndarray:
        """Distances (N,) below the nearest side."""
        depth = np.zeros(len(position))
        for some in self._rows(position):
            depth[some] = self._gaps(position[some]).min(axis=1)
        return depth

    def _rows(self, position: np.ndarray) -> list[slice]:
        """Positions (N, dim) in blocks, of which the distances from all sides are held at once."""
        return _blocks(len(position), len(self.outline.distance))

    def _gaps(self, position: np.ndarray) -> np.ndarray:
        """Distances (N, m) below the planes of the sides."""
        normal, distance = self.planes
        return distance - position @ normal.T

    def samples(self, dp: float) -> np.ndarray:
        """Corners, and points along edges no farther apart than dp.

        Where two convex bodies touch there is one of these on one of them.
        """
        points = [self.outline.corners]
        for start, end in self.outline.edges:
            parts = int(np.ceil(np.linalg.norm(end - start) / dp * (1 - BULGE)))
            share = np.arange(1, parts)[:, None] / max(parts, 1)
            points.append(start + share * (end - start))
        return np.concatenate(points)

    def table(self, dp: float) -> dict[str, Any]:
        """The shape as the core reads it."""
        return {
            "vertices": np.ascontiguousarray(self.vertices),
            "faces": np.ascontiguousarray(self.faces, np.int32),
            "samples": np.ascontiguousarray(self.samples(dp)),
        }


def _blocks(number: int, each: int) -> list[slice]:
    """So many rows of so many numbers in parts that are no larger than AT_ONCE."""
    step = max(AT_ONCE // max(each, 1), 1)
    return [slice(start, start + step) for start in range(0, number, step)]


def _innermost(depth: np.ndarray, number: float) -> np.ndarray:
    """The part (N,) of each point in a number of the deepest; depths in spacings."""
    order = np.argsort(-depth, kind="stable")
    level = np.append(0, np.cumsum(-np.diff(depth[order]) > SAME_DEPTH))
    count = np.bincount(level)
    part = np.clip((number - (np.cumsum(count) - count)) / count, 0, 1)
    part[0] = max(part[0], LEAST)
    part[part < LEAST] = 0
    result = np.empty(len(depth))
    result[order] = part[level]
    return result
