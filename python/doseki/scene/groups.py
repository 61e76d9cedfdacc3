"""Groups of rigid or deformable bodies: where they stand, their particles, what lies inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..scenario.kinematics import BREAKABLE, ELASTIC, FIXED, SINGLE, Kinematics
from ..scenario.model import Scenario
from .meshes.evening import evened
from .periodic import nearest_image, periods, wrapped
from .shapes import Ball, Convex, Edges, MeshShape, Particles, Shape, no_edges

WALL_DEPTH = 4.0  # spacings below the sides of a wall, within which particles act on a flow
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Group:
    """The n bodies of one table [body.NAME]."""

    name: str
    shapes: list[Shape]
    shape: np.ndarray  # (n,) index into shapes
    centre: np.ndarray  # (n, dim), m
    orientation: np.ndarray  # (n, 4) quaternion w, x, y, z
    material: str
    kinematics: Kinematics

    def __len__(self) -> int:
        return len(self.centre)

    @property
    def fixed(self) -> bool:
        """Whether they do not move, or only as is prescribed."""
        return self.kinematics is FIXED

    @property
    def single(self) -> bool:
        """Whether each is one particle."""
        return self.kinematics is SINGLE

    @property
    def elastic(self) -> bool:
        """Whether they are deformable."""
        return self.kinematics is ELASTIC

    @property
    def breakable(self) -> bool:
        """Whether they are rigid until they are struck."""
        return self.kinematics is BREAKABLE

    @property
    def deforms(self) -> bool:
        """Whether they are deformable, at once or when they are struck."""
        return self.elastic or self.breakable

    @property
    def measures(self) -> tuple[np.ndarray, np.ndarray]:
        """Area, m2, or volume, m3, (n,) of each body, and what of it fluid cannot enter."""
        true = np.array([shape.measure for shape in self.shapes])
        wet = np.array([shape.wet_measure for shape in self.shapes])
        return true[self.shape], wet[self.shape]


def quaternion_of(degrees: float, dim: int, axis: np.ndarray | None) -> np.ndarray:
    """The quaternion (4,) of a rotation; the axes are those of lattices.rotation_matrix."""
    half = 0.5 * np.radians(degrees)
    about = np.array([0.0, 0.0, 1.0] if dim == 2 else [0.0, -1.0, 0.0])
    if axis is not None:
        about = axis / np.linalg.norm(axis)
    return np.array([np.cos(half), *(np.sin(half) * about)])


def matrices(orientation: np.ndarray, dim: int) -> np.ndarray:
    """Rotation matrices (n, dim, dim) of quaternions (n, 4)."""
    w, x, y, z = orientation.T
    full = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.moveaxis(full, 2, 0)[:, :dim, :dim]


def particles_of(group: Group, spacing: float, dim: int) -> tuple[Particles, np.ndarray]:
    """Particles of all bodies of a group where they stand, and the body of each within it."""
    parts: list[Particles] = []
    owners: list[np.ndarray] = []
    turns = matrices(group.orientation, dim)
    for k, shape in enumerate(group.shapes):
        own = _own_particles(group, shape, spacing)
        which = np.flatnonzero(group.shape == k)
        parts.append(_placed(own, group.centre[which], turns[which]))
        owners.append(np.repeat(which, len(own.depth)))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")

    def joined(column: Callable[[Particles], np.ndarray]) -> np.ndarray:
        return np.concatenate([column(part) for part in parts])[order]

    edges = Edges(joined(lambda part: part.edges.normals), joined(lambda part: part.edges.depths))
    return Particles(
        position=joined(lambda part: part.position),
        normal=joined(lambda part: part.normal),
        depth=joined(lambda part: part.depth),
        curvature=joined(lambda part: part.curvature),
        share=joined(lambda part: part.share),
        edges=edges,
    ), owner[order]


def _placed(own: Particles, centre: np.ndarray, turn: np.ndarray) -> Particles:
    """Those of n bodies with the same particles, at their centres (n, dim), turned by matrices."""
    n, dim = centre.shape
    position = centre[:, None, :] + np.einsum("nab,pb->npa", turn, own.position)
    normal = np.einsum("nab,pb->npa", turn, own.normal)
    faces = np.einsum("nab,pfb->npfa", turn, own.edges.normals)
    return Particles(
        position=position.reshape(-1, dim),
        normal=normal.reshape(-1, dim),
        depth=np.tile(own.depth, n),
        curvature=np.tile(own.curvature, n),
        share=np.tile(own.share, n),
        edges=Edges(faces.reshape(-1, dim, dim), np.tile(own.edges.depths, (n, 1))),
    )


def _own_particles(group: Group, shape: Shape, spacing: float) -> Particles:
    """The particles of one body in its frame."""
    if isinstance(shape, MeshShape):
        raise TypeError("particles of a mesh are no parts of a body")
    if group.single:
        return shape.single()
    if group.deforms:
        own = shape.elastic_particles(spacing)
        return own if group.breakable else own._replace(edges=no_edges(*own.position.shape))
    if not isinstance(shape, Convex):
        return shape.particles(spacing)
    position, share = shape.filling(spacing)
    position = evened(shape, position, spacing, WALL_DEPTH * spacing)
    if not group.fixed:
        position = position - share @ position
    return shape.beneath(position, share, spacing)


def boxes(group: Group) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends (n, dim) along the axes of the bodies as they stand, from their centres.

    In m.
    """
    dim = group.centre.shape[1]
    turns = matrices(group.orientation, dim)
    low, high = np.empty((2, len(group), dim))
    for k, shape in enumerate(group.shapes):
        which = group.shape == k
        if isinstance(shape, Ball):
            low[which], high[which] = -shape.radius, shape.radius
            continue
        corners = shape.vertices if isinstance(shape, Convex) else shape.mesh.vertices
        placed = np.einsum("nab,pb->npa", turns[which], corners)
        low[which], high[which] = placed.min(axis=1), placed.max(axis=1)
    return low, high


def inside_bodies(scenario: Scenario, groups: list[Group], position: np.ndarray) -> np.ndarray:
    """Whether each position (N, dim) lies inside a body of one of the groups."""
    from scipy.spatial import cKDTree

    inside = np.zeros(len(position), bool)
    if not len(position):
        return inside
    period = periods(scenario)
    low = np.zeros(scenario.dim) if scenario.domain_min is None else scenario.domain_min
    origin = np.where(period > 0, low, 0.0)  # the tree's box begins at zero
    tree = cKDTree(wrapped(scenario, position) - origin, boxsize=period)
    for group in groups:
        middle = 0.5 * np.add(*boxes(group))  # a body that spans a period has its mass elsewhere
        for k, turned in enumerate(matrices(group.orientation, scenario.dim)):
            shape, centre = group.shapes[group.shape[k]], group.centre[k]
            near = np.array(tree.query_ball_point(centre - origin, shape.reach), dtype=np.int64)
            offset = nearest_image(position[near] - centre - middle[k], period) + middle[k]
            inside[near[shape.contains(offset @ turned)]] = True
    return inside
