"""The bodies of a scene: rigid and fixed ones in groups, deformable ones by their particles."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .groups import Group
from .meshes.cells import Cells

LEAST = 0.1  # spacings: the least radius of a ball


@dataclass(frozen=True)
class ElasticSurface:
    """Its vertices at rest, not wrapped; in 2-D those of a closed curve, anticlockwise.

    In 3-D each has the outward normal there and stands for an area, or is a ball around its
    particle, where both are 0, as they are in 2-D.
    """

    vertex: np.ndarray  # (m, dim) m
    carrier: np.ndarray  # (m,) the particle, counted within the body, with which each goes
    crease: np.ndarray  # (m,) bool: where smooth parts of the curve end
    outward: np.ndarray  # (m, dim)
    share: np.ndarray  # (m,) the area, over spacing^2
    radius: np.ndarray  # (m,) m, of balls; 0: of a surface


def balls_around(rest: np.ndarray, depth: np.ndarray, spacing: float) -> ElasticSurface:
    """Of the outermost particles of a 3-D body, which are at `rest` (n, 3), so deep in it (n,).

    Each reaches to the face: where the sides of a body are no whole number of spacings, balls of
    half a spacing would begin inside what it lies on.
    """
    particles = np.flatnonzero(depth < spacing)
    none = np.zeros(len(particles))
    radius = np.maximum(depth[particles], LEAST * spacing)
    return ElasticSurface(
        rest[particles], particles, none.astype(bool), np.zeros((len(particles), 3)), none, radius
    )


@dataclass(frozen=True)
class ElasticBody:
    """One deformable body: n of the particles of a run."""

    name: str  # of its table
    material: str
    members: np.ndarray  # (n,) int32, indices of particles
    rest: np.ndarray  # (n, dim) where they are without stress, m; not wrapped
    position: np.ndarray  # (n, dim) where they start, m; not wrapped
    velocity: np.ndarray  # (n, dim) at the start, m/s
    spacing: float  # each particle has spacing^dim of its volume, m
    clamped: np.ndarray  # (n,) bool: does not move
    surface: ElasticSurface  # which touches other bodies
    cells: Cells = field(default_factory=Cells)  # 2-D, of one that may break
    rigid_first: bool = False  # one of the rigid bodies until it is struck


@dataclass(frozen=True)
class Bodies:
    """Bodies that move (first) and fixed ones that they touch; none where nothing moves.

    For each particle: `grain`, the index of its body or -1, and for those of bodies the outward
    `normal`, the `depth` below the surface, m, its `curvature`, 1/m, and the Edges; `shaped` tells
    which particles have these.
    """

    groups: list[Group]
    velocity: np.ndarray  # (n, dim) m/s, of all bodies in order
    spin: np.ndarray  # (n, 3) rad/s
    grain: np.ndarray  # (N,) int32
    shaped: np.ndarray  # (N,) bool
    normal: np.ndarray  # (N, dim)
    depth: np.ndarray  # (N,)
    curvature: np.ndarray  # (N,)
    edge_normals: np.ndarray  # (N, dim, dim)
    edge_depths: np.ndarray  # (N, dim)
    elastic: list[ElasticBody] = field(default_factory=list)  # in `groups` only if `rigid_first`

    def __len__(self) -> int:
        return sum(len(group) for group in self.groups)
