"""What other walls leave of the surface of a structure, which may reach into its bed and banks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....record.particles import FIXED
from ..gauge import State
from .surface import PARTS

FLUSH = 0.2  # spacings within which a face that lies on a wall is covered by it
PARALLEL = 0.9  # cosine from which on a face and a wall lie on each other
WITHIN = 1.0  # spacings to the nearest particle of a wall; less within one
BESIDE = 2.0  # spacings to the nearest particle of another body; farther off, none covers a piece
CLEAR = 0.5  # spacings above a wall: its first row of fluid
DEEPEST = 1.5  # spacings below a wall; what is farther down has no fluid beside it
WALL = ("position", "normal", "depth")


def left_by_walls(
    parts: np.ndarray, normal: np.ndarray, body: np.ndarray, around: State, dp: float
) -> tuple[np.ndarray, np.ndarray]:
    """The share (n,) of each piece that is outside of the walls of other bodies, and its middle.

    A piece consists of `parts` (n, p, dim), m, of the same area; it faces along the unit vector
    `normal` and belongs to `body`.  Where nothing is left the middle (n, dim) is that of the piece.
    """
    middle = parts.mean(axis=1)
    share, place = np.ones(len(parts)), middle.copy()
    for mine, walls in _beside(place, body, around, dp):
        free = _free(parts[mine], normal[mine], walls, dp)
        share[mine] = free.mean(axis=1)
        weights = free / np.maximum(free.sum(axis=1), 1e-300)[:, None]
        moved = np.einsum("np,npa->na", weights, parts[mine])
        middle[mine] = np.where(share[mine, None] > 0, moved, place[mine])
    return share, middle


def clear_of_walls(points: np.ndarray, body: np.ndarray, around: State, dp: float) -> np.ndarray:
    """Points (n, dim) in front of pieces of bodies, moved out of the walls of other ones."""
    moved = points.copy()
    for mine, walls in _beside(points, body, around, dp):
        _, nearest, height = _above(points[mine], walls)
        lift = np.where(height > -DEEPEST * dp, np.maximum(0.0, CLEAR * dp - height), 0.0)
        moved[mine] += lift[:, None] * walls["normal"][nearest]
    return moved


def _beside(
    points: np.ndarray, body: np.ndarray, around: State, dp: float
) -> Iterator[tuple[np.ndarray, State]]:
    """For each body those of its points that walls of other ones are near, and these walls."""
    from scipy.spatial import cKDTree

    fixed = np.flatnonzero(around["motion"] == FIXED)
    reach = BESIDE * dp
    for each in np.unique(body):
        mine = np.flatnonzero(body == each)
        low, high = points[mine].min(axis=0) - reach, points[mine].max(axis=0) + reach
        others = fixed[around["body"][fixed] != each]
        place = around["position"][others]
        others = others[((place > low) & (place < high)).all(axis=1)]
        if len(others):
            walls = {key: around[key][others] for key in WALL}
            near = cKDTree(walls["position"]).query(points[mine])[0] < reach
            yield mine[near], walls


def _free(parts: np.ndarray, normal: np.ndarray, walls: State, dp: float) -> np.ndarray:
    """How much (n, p) of each part of pieces (n, p, dim) is above the nearest wall.

    A face that lies on a wall has nothing above it, one that faces the same way all.
    """
    distance, nearest, height = _above(parts, walls)
    facing = np.einsum("npa,na->np", walls["normal"][nearest], normal)
    along = np.clip((np.abs(facing) - PARALLEL) / (1 - PARALLEL), 0.0, 1.0)
    height = height + FLUSH * dp * np.sign(facing) * along
    return np.where(distance < WITHIN * dp, np.clip(0.5 + height * PARTS / dp, 0.0, 1.0), 1.0)


def _above(points: np.ndarray, walls: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far the nearest wall particle is, which it is, and the height above its surface, m."""
    from scipy.spatial import cKDTree

    distance, nearest = cKDTree(walls["position"]).query(points)
    away = points - walls["position"][nearest]
    height = (away * walls["normal"][nearest]).sum(axis=-1) - walls["depth"][nearest]
    return distance, nearest, height
