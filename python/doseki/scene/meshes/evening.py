"""Particles of a wall, shifted until they are evenly spaced below its surface.  Lengths in m.

Particles repel each other, and what would lie beyond the surface repels them as a lattice does
whose first plane is half a spacing outside; those of the first row are drawn to half a spacing
below it.  A lattice along a face is at rest.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..shapes import Convex, MeshShape

REACH = 2.0  # dp: how far particles repel each other
OFF = 0.05  # dp: a particle so far from its layer is out of place
STEPS = 12  # later ones change little, but take particles away from the surface
GAIN = 0.2  # dp of shift for a repulsion of 1
LONGEST = 0.1  # dp in one step
FIRST_ROW = 1.0  # force on a particle of the first row that is 1 dp away from its place
OUTSIDE = 0.9  # of a lattice beyond the surface: particles without order press less than one
SHALLOWEST = 0.35  # dp below the surface


def evened(shape: MeshShape | Convex, position: np.ndarray, dp: float, depth: float) -> np.ndarray:
    """Positions (N, dim), the deepest of which stay where they are; `depth` is that of the wall."""
    below = shape.wall(position, dp)[1]
    moving = _out_of_place(position, below, dp) & (below < depth - 0.5 * dp)
    if not moving.any():
        return position
    x = position.copy()
    near = cKDTree(x).query_ball_point(x[moving], 2 * REACH * dp, return_length=False)
    there = np.unique(np.concatenate([np.asarray(each, np.int64) for each in near]))
    own = moving[there]
    x[there] = _shifted(shape, x[there], own, dp)
    return x


def _out_of_place(position: np.ndarray, below: np.ndarray, dp: float) -> np.ndarray:
    """Particles that are in no layer, or near some that are not."""
    layer = below / dp - 0.5
    off = np.abs(layer - np.rint(layer)) > OFF
    if not off.any():
        return off
    return np.asarray(cKDTree(position[off]).query(position, 1)[0] < 1.5 * dp)


def _shifted(shape: MeshShape | Convex, x: np.ndarray, moving: np.ndarray, dp: float) -> np.ndarray:
    own = np.flatnonzero(moving)
    start = x[own].copy()
    normal, below = shape.wall(start, dp)
    for _ in range(STEPS):
        inwards = _inwards(below / dp, x.shape[1])[:, None] * normal
        force = _repulsion(x, moving, dp)[own] - inwards
        shift = GAIN * dp * force
        length = np.linalg.norm(shift, axis=1)
        shift *= np.minimum(1.0, LONGEST * dp / np.maximum(length, 1e-300))[:, None]
        gone = x[own] + shift - start
        distance = np.linalg.norm(gone, axis=1)
        x[own] = start + gone * np.minimum(1.0, dp / np.maximum(distance, 1e-300))[:, None]
        normal, below = shape.wall(x[own], dp)
        raised = np.maximum(SHALLOWEST * dp - below, 0)
        x[own] -= raised[:, None] * normal
        below += raised
    return x


def _repulsion(x: np.ndarray, moving: np.ndarray, dp: float) -> np.ndarray:
    """Sums (N, dim) of (1 - r/reach)^2 along the way from each neighbour."""
    pairs = cKDTree(x).query_pairs(REACH * dp, output_type="ndarray")
    i, j = pairs[moving[pairs].any(axis=1)].T
    apart = x[i] - x[j]
    r = np.linalg.norm(apart, axis=1)
    pull = ((1 - r / (REACH * dp)) ** 2 / np.maximum(r, 1e-9 * dp))[:, None] * apart
    force = np.zeros_like(x)
    for a in range(x.shape[1]):
        force[:, a] = np.bincount(i, pull[:, a], len(x)) - np.bincount(j, pull[:, a], len(x))
    return force


def _inwards(depth: np.ndarray, dim: int) -> np.ndarray:
    """Force from the surface: of what would lie beyond it, and towards the first row's place."""
    return OUTSIDE * _of_outside(depth, dim) + FIRST_ROW * np.where(depth < 1, 0.5 - depth, 0.0)


def _of_outside(depth: np.ndarray, dim: int) -> np.ndarray:
    """What a lattice does that begins half a spacing outside; depths in spacings."""
    steps = np.arange(-REACH, REACH + 1)
    u, v = np.meshgrid(steps, steps if dim == 3 else [0.0])
    table = np.linspace(0, REACH, 81)
    planes = table[:, None] + 0.5 + np.arange(0, REACH)[None, :]
    z = planes[:, :, None, None]
    r = np.sqrt(u**2 + v**2 + z**2)
    total = (np.maximum(1 - r / REACH, 0) ** 2 * z / r).sum(axis=(1, 2, 3))
    return np.interp(depth, table, total)
