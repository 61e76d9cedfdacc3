"""Positions on square and cubic lattices, and their rotation.  Lengths in m."""

from __future__ import annotations

import numpy as np

# A count or a radius that is a whole number of spacings may come out of division a hair off.
ROUNDING = 1e-9


def box_counts(low: np.ndarray, high: np.ndarray, spacing: float) -> np.ndarray:
    """Particles along each side of a box, as whole floats (they may be too large for integers)."""
    return np.rint((high - low) / spacing)


def box_lattice(low: np.ndarray, counts: np.ndarray, spacing: float, keep: int) -> np.ndarray:
    """The first `keep` cell centres low + (k + 1/2) spacing, layer upon layer along the last axis.

    A layer that is not full is full up to some x, over all of y.
    """
    slow_to_fast = [1, 0] if len(low) == 2 else [2, 0, 1]
    sides = counts.astype(np.int64)[slow_to_fast]
    cells = np.empty((keep, len(low)))
    cells[:, slow_to_fast] = np.column_stack(np.unravel_index(np.arange(keep), sides))
    return low + (cells + 0.5) * spacing


def disc_lattice(centre: np.ndarray, radius: float, spacing: float) -> np.ndarray:
    """Lattice points nearer to `centre` than `radius`; one of them is the centre itself."""
    rim = int(np.ceil(radius / spacing))
    reach = np.arange(-rim, rim + 1)
    cells = np.stack(np.meshgrid(*[reach] * len(centre), indexing="ij"), axis=-1)
    cells = cells.reshape(-1, len(centre))
    inside = (cells**2).sum(axis=1) < (radius / spacing) ** 2 * (1 - ROUNDING)
    return centre + cells[inside] * spacing


def ball_measure(radius: float, dim: int) -> float:
    """Area of a disc, volume of a sphere."""
    return np.pi * radius**2 if dim == 2 else 4 / 3 * np.pi * radius**3


def rotated(
    position: np.ndarray, degrees: float, pivot: np.ndarray, axis: np.ndarray | None = None
) -> np.ndarray:
    """Positions (N, dim) turned about `pivot`, the first axis towards the last.

    In 3-D an `axis` asks for a right-handed rotation about it instead.
    """
    if degrees == 0:
        return position
    matrix = rotation_matrix(degrees, position.shape[1], axis)
    return pivot + (position - pivot) @ matrix.T


def rotation_matrix(degrees: float, dim: int, axis: np.ndarray | None = None) -> np.ndarray:
    """The matrix (dim, dim) of `rotated`."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    if dim == 2:
        return np.array([[cos, -sin], [sin, cos]])
    # Right-handed about -y is x towards z, which is the sense of a 2-D rotation.
    u = np.array([0.0, -1.0, 0.0]) if axis is None else axis / np.linalg.norm(axis)
    cross = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return cos * np.eye(3) + sin * cross + (1 - cos) * np.outer(u, u)
