"""Particles of walls that thin to nothing on others, in rows below their slanted sides.

Where a ramp is thinner than dp it has no particles, and its surface would be that of what it lies
on, which makes a step of it.  So its own rows there are brought to their depths below the slanted
side, and the particles of what it lies on go along as the rows that come next.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from ...scenario.model import Scenario
from ..kinds.body import Body
from .covering import Covering, Slant

THIN = 4.0  # dp: where a wall is thinner, its rows are those of its lattice, not evened ones
COLUMN = 0.45  # dp: particles of a column are no farther from its axis
NEAR = 0.7  # dp to the nearest particle, from a place in a row that is there


def ways_into_rows(
    scenario: Scenario, bodies: Mapping[str, Body[Any]], walls: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """By how much (n, dim) the particles of fixed bodies are to be moved.

    `walls` are the positions (n, dim) of those that each was made with.
    """
    covering, dp = Covering(scenario, bodies, walls), scenario.dp
    moved = {name: position.copy() for name, position in walls.items()}
    for name, position in walls.items():
        faces = bodies[name].plane_faces()
        if faces is None:
            continue
        for slant in covering.slants(name, faces):
            foot = position[slant.rows] + slant.depth[:, None] * slant.up
            moved[slant.over] = _in_columns(slant, foot, moved[slant.over], dp)
            rows = _rows_above(slant, foot, moved[slant.over], dp)
            depth = dp * rows + slant.depth
            near = depth < scenario.support + 0.5 * dp
            rise = (slant.below - depth)[near, None] / slant.lean
            moved[name][slant.rows[near]] = position[slant.rows[near]] + rise * slant.up
    return {name: moved[name] - position for name, position in walls.items()}


def _in_columns(slant: Slant, foot: np.ndarray, position: np.ndarray, dp: float) -> np.ndarray:
    """Positions (n, dim) of the upper body, of which thin columns have their rows in their depths.

    Columns are those over places `foot` on the side on which it lies.
    """
    height = (position - foot[0]) @ slant.up
    thickness = slant.below[0] - slant.depth[0] * slant.lean  # at the first place
    below = thickness - (position - foot[0]) @ slant.normal
    across = position - height[:, None] * slant.up
    over_foot = cKDTree(foot).query(across, distance_upper_bound=dp)[0] < dp
    thin = np.flatnonzero(over_foot & (below + height * slant.lean < THIN * dp))
    if not len(thin):
        return position
    across = across[thin]
    near = cKDTree(across).query_ball_point(across, COLUMN * dp)
    above = [(below[thin[each]] < below[k]).sum() for each, k in zip(near, thin, strict=True)]
    rise = (below[thin] - (np.array(above) + 0.5) * dp) / slant.lean
    moved = position.copy()
    moved[thin] += rise[:, None] * slant.up
    return moved


def _rows_above(slant: Slant, foot: np.ndarray, over: np.ndarray, dp: float) -> np.ndarray:
    """How many rows (n,) of particles of the upper body are over those of the lower one."""
    thickness = slant.below - slant.depth * slant.lean
    tree, rows = cKDTree(over), np.zeros(len(foot))
    goes_on = np.ones(len(foot), bool)
    while goes_on.any():
        height = (thickness - (rows + 0.5) * dp) / slant.lean
        place = foot + height[:, None] * slant.up
        goes_on &= (height > -0.5 * dp) & (tree.query(place)[0] < NEAR * dp)
        rows[goes_on] += 1
    return rows
