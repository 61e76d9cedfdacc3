"""Shapes of bodies in their own frame, about their centre of mass: geometry and particles.

Discs and spheres (Ball), convex polygons and polyhedra (Convex).  Lengths in m.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import UserError
from ..util.foreign import read_bytes, readable
from .lattices import ball_measure

GOLDEN = np.pi * (3 - np.sqrt(5))  # angle, rad
FLAT = 1e-9  # of the size: below, points lie on one line or plane
LARGEST_STL = 50_000_000  # bytes
BULGE = 1e-4  # of the size: by which a surface may miss being convex (files hold single precision)


class ShapeError(UserError):
    """A polygon or a mesh that cannot be a body."""


class Particles(NamedTuple):
    """Particles of a shape, which share its mass equally."""

    position: np.ndarray  # (N, dim), m
    normal: np.ndarray  # (N, dim) outwards, zero in the centre of a ball
    depth: np.ndarray  # (N,) below the surface, m


@dataclass(frozen=True)
class Ball:
    """A disc (dim = 2) or sphere (dim = 3); fluid meets it at `wetted` times its radius."""

    radius: float
    dim: int
    wetted: float = 1.0

    @property
    def measure(self) -> float:
        """Area, m2, or volume, m3."""
        return ball_measure(self.radius, self.dim)

    @property
    def wet_measure(self) -> float:
        """Area or volume that fluid cannot enter."""
        return ball_measure(self.wetted * self.radius, self.dim)

    @property
    def inertia(self) -> np.ndarray:
        """Inertia tensor (3, 3) over the mass, m2; of a disc only [2, 2]."""
        square = self.radius**2
        return np.diag([0, 0, square / 2]) if self.dim == 2 else 0.4 * square * np.eye(3)

    @property
    def width(self) -> float:
        """Smallest extent."""
        return 2 * self.radius

    @property
    def reach(self) -> float:
        """Radius of the circumscribed ball."""
        return self.radius

    def particles(self, dp: float) -> Particles:
        """Concentric rings or shells dp apart, the outermost dp/2 below the surface."""
        radius = self.radius * self.wetted
        outermost = radius - 0.5 * dp
        if outermost < 0.25 * dp:
            return self.single()
        radii = _ring_radii(outermost, dp)
        edges = np.append(0.5 * (radii[1:] + radii[:-1]), radius)
        shares = np.diff([0.0, *(ball_measure(r, self.dim) for r in edges)]) / dp**self.dim
        rings = [
            r * _directions(max(1, round(share)), self.dim, k * GOLDEN)
            for k, (r, share) in enumerate(zip(radii, shares, strict=True))
        ]
        position = np.concatenate(rings)
        distance = np.linalg.norm(position, axis=1)
        normal = position / np.maximum(distance, 1e-300)[:, None]
        return Particles(position, normal, radius - distance)

    def elastic_particles(self, dp: float) -> Particles:
        """A disc as rings of 6, 12, 18 ... particles around one, a hexagonal lattice that is bent.

        Any two such discs meet point to point along x. Balls of the diameter of a particle in the
        outermost ring touch the circle from inside.
        """
        if self.dim == 3:
            return self.particles(dp)
        number = max(1, round(self.radius / dp))
        share = self.measure / (3 * number * (number + 1) + 1)  # area of each
        step = (self.radius - 0.5 * np.sqrt(share)) / number
        angles = [2 * np.pi * np.arange(6 * k) / (6 * k) for k in range(1, number + 1)]
        rings = [
            k * step * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            for k, angle in enumerate(angles, start=1)
        ]
        position = np.concatenate([np.zeros((1, 2)), *rings])
        distance = np.linalg.norm(position, axis=1)
        normal = position / np.maximum(distance, 1e-300)[:, None]
        return Particles(position, normal, self.radius - distance)

    def contains(self, position: np.ndarray) -> np.ndarray:
        """Whether positions (N, dim) lie inside."""
        return (position**2).sum(axis=1) < (self.wetted * self.radius) ** 2

    def single(self) -> Particles:
        """One particle in the centre."""
        zero = np.zeros((1, self.dim))
        return Particles(zero, zero.copy(), np.array([self.wetted * self.radius]))

    def table(self, dp: float) -> dict[str, Any]:
        """The shape as the core reads it."""
        return {"radius": self.radius}


def _ring_radii(outermost: float, dp: float) -> np.ndarray:
    """Radii from the centre or dp/2 on, whichever lets them lie more nearly dp apart."""
    steps = outermost / dp
    around_centre = abs(steps - round(steps)) <= abs(steps - 0.5 - round(steps - 0.5))
    inner = 0.0 if around_centre else 0.5
    number = max(round(steps - inner), 0)
    return outermost * (np.arange(number + 1) + inner) / (number + inner or 1.0)


def _directions(n: int, dim: int, turn: float) -> np.ndarray:
    """Unit vectors (n, dim) evenly spread whose mean is zero (one alone: the zero vector)."""
    if n == 1:
        return np.zeros((1, dim))
    if dim == 2:
        angle = turn + 2 * np.pi * np.arange(n) / n
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    z = 1 - (2 * np.arange(n) + 1) / n  # Fibonacci lattice on the sphere
    angle, rho = turn + GOLDEN * np.arange(n), np.sqrt(1 - z**2)
    unit = np.stack([rho * np.cos(angle), rho * np.sin(angle), z], axis=1)
    for _ in range(30):  # without this the centre of mass would lie beside that of the body
        unit -= unit.mean(axis=0)
        unit /= np.linalg.norm(unit, axis=1)[:, None]
    return unit


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
    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Unit normals (m, dim) of the faces, outwards, and their distances from the centre."""
        corners = self.vertices[self.faces]
        side = corners[:, 1] - corners[:, 0]
        if self.dim == 2:
            normal = np.stack([side[:, 1], -side[:, 0]], axis=1)
        else:
            normal = np.cross(side, corners[:, 2] - corners[:, 0])
        normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        both = np.column_stack([normal, np.einsum("md,md->m", normal, corners[:, 0])])
        scale = np.append(np.ones(self.dim), self.reach)
        _, first = np.unique(np.round(both / scale, 7), axis=0, return_index=True)
        both = both[np.sort(first)]  # one plane for the triangles of one side
        return both[:, :-1], both[:, -1]

    @property
    def width(self) -> float:
        """Smallest extent across a face."""
        normal, distance = self.planes
        return float((distance - (self.vertices @ normal.T).min(axis=0)).min())

    @property
    def reach(self) -> float:
        """Radius of the circumscribed ball."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    def particles(self, dp: float) -> Particles:
        """The innermost points of a lattice, as many as fill the shape; their mean is zero."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        counts = np.maximum(np.rint((high - low) / dp), 1).astype(int)
        cell = (high - low) / counts
        steps = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
        lattice = low + (steps.reshape(-1, self.dim) + 0.5) * cell
        number = max(1, round(self.measure / float(np.prod(cell))))
        innermost = np.argsort(-np.round(self._depth(lattice)[0] / dp, 9), kind="stable")
        position = lattice[np.sort(innermost[:number])]
        position = position - position.mean(axis=0)
        depth, face = self._depth(position)
        return Particles(position, self.planes[0][face], depth)

    def elastic_particles(self, dp: float) -> Particles:
        """The same as those of a rigid body."""
        return self.particles(dp)

    def single(self) -> Particles:
        """One particle in the centre."""
        zero = np.zeros((1, self.dim))
        return Particles(zero, zero.copy(), self._depth(zero)[0])

    def contains(self, position: np.ndarray) -> np.ndarray:
        """Whether positions (N, dim) lie inside."""
        return self._depth(position)[0] > 0

    def _depth(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        normal, distance = self.planes
        gaps = distance - position @ normal.T
        face = gaps.argmin(axis=1)
        return gaps[np.arange(len(gaps)), face], face

    def samples(self, dp: float) -> np.ndarray:
        """Vertices, and points along edges no farther apart than dp."""
        edges = np.sort(_edges(self.faces), axis=1)
        points = [self.vertices]
        for a, b in np.unique(edges, axis=0):
            start, end = self.vertices[a], self.vertices[b]
            parts = int(np.ceil(np.linalg.norm(end - start) / dp * (1 - FLAT)))
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


def _edges(faces: np.ndarray) -> np.ndarray:
    if faces.shape[1] == 2:
        return faces
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


Shape = Ball | Convex


def box_shape(sides: np.ndarray) -> Convex:
    """A rectangle or cuboid with these sides."""
    if len(sides) == 2:
        corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
        return polygon_shape(corners * sides)[0]
    import trimesh

    return _from_mesh(trimesh.creation.box(extents=sides))[0]


def polygon_shape(corners: np.ndarray) -> tuple[Convex, np.ndarray]:
    """A convex polygon from its corners (n, 2) in order, and its centre of mass.

    Raises ShapeError where the corners are not those of a convex polygon.
    """
    x, y = corners.T
    after = np.roll(corners, -1, axis=0)
    cross = x * after[:, 1] - y * after[:, 0]
    area, size = 0.5 * cross.sum(), float(np.ptp(corners, axis=0).max())
    if abs(area) < FLAT * size**2 or (after == corners).all(axis=1).any():
        raise ShapeError("its corners enclose no area, or two of them are the same")
    if area < 0:
        return polygon_shape(corners[::-1])
    centre = ((corners + after) * cross[:, None]).sum(axis=0) / (6 * area)
    vertices = corners - centre
    after = np.roll(vertices, -1, axis=0)
    side, next_side = after - vertices, np.roll(after - vertices, -1, axis=0)
    bend = side[:, 0] * next_side[:, 1] - side[:, 1] * next_side[:, 0]
    turns = np.arctan2(bend, (side * next_side).sum(axis=1)).sum()
    if (bend < -BULGE * size**2).any() or turns > 3 * np.pi:
        raise ShapeError("it is not convex")
    cross = vertices[:, 0] * after[:, 1] - vertices[:, 1] * after[:, 0]
    square = (vertices**2).sum(1) + (vertices * after).sum(1) + (after**2).sum(1)
    inertia = np.diag([0, 0, float((cross * square).sum() / 12 / area)])
    index = np.arange(len(vertices))
    faces = np.stack([index, np.roll(index, -1)], axis=1).astype(np.int32)
    return Convex(vertices, faces, float(area), inertia), centre


def mesh_shape(file: Path, scale: float) -> tuple[Convex, np.ndarray]:
    """The polyhedron in an STL file, and its centre of mass in the file's frame, m.

    Raises ShapeError where the file cannot be read, or its surface is not closed or not convex.
    """
    try:
        content = read_bytes(file, LARGEST_STL)
        with readable(file, " as STL"):
            mesh = _closed_mesh(file, content)
    except UserError as error:
        raise ShapeError(str(error)) from None
    mesh.apply_scale(scale)
    shape, centre = _from_mesh(mesh)
    normal, distance = shape.planes
    beyond = float((shape.vertices @ normal.T - distance).max())
    if beyond > BULGE * shape.reach:
        raise ShapeError(
            f"the surface in {file} is not convex (by {beyond:.3g} m); cut it into convex bodies"
        )
    return shape, centre


def _closed_mesh(file: Path, content: bytes) -> Any:
    import trimesh

    mesh = trimesh.load_mesh(io.BytesIO(content), file_type="stl")
    if not np.isfinite(mesh.vertices).all():
        raise UserError(f"{file}: a vertex is not finite")
    mesh.merge_vertices()
    if len(mesh.faces) < 4 or not mesh.is_watertight:
        raise UserError(f"the surface in {file} is not closed")
    mesh.faces = _outwards(np.array(mesh.vertices), np.array(mesh.faces))
    return mesh


def _outwards(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Triangles of a convex surface with their normals outwards, whichever way they turned."""
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = np.einsum("md,md->m", normal, corners[:, 0] - corners.mean(axis=(0, 1)))
    return np.where((outward < 0)[:, None], faces[:, ::-1], faces)


def _from_mesh(mesh: Any) -> tuple[Convex, np.ndarray]:
    if not mesh.volume > 0:
        raise ShapeError("the surface encloses no volume")
    centre = np.array(mesh.center_mass, dtype=float)
    vertices = np.array(mesh.vertices, dtype=float) - centre
    inertia = np.array(mesh.moment_inertia, dtype=float) / float(mesh.mass)
    return Convex(vertices, np.array(mesh.faces, np.int32), float(mesh.volume), inertia), centre
