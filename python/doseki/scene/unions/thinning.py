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
from ..periodic import nearest_image, periods
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
    covering, period, dp = Covering(scenario, bodies, walls), periods(scenario), scenario.dp
    ways = {name: np.zeros_like(position) for name, position in walls.items()}
    for name in walls:
        for slant in covering.slants(name):
            over = nearest_image(walls[slant.over] + ways[slant.over] - slant.middle, period)
            over += slant.middle
            way = _into_columns(slant, over, dp)
            ways[slant.over] += way
            rows = _rows_above(slant, over + way, scenario.support + dp, dp)
            depth = dp * rows + slant.depth
            near = depth < scenario.support + 0.5 * dp
            rise = (slant.below - depth)[near, None] / slant.lean
            ways[name][slant.rows[near]] += rise * slant.up
    return ways


def _into_columns(slant: Slant, position: np.ndarray, dp: float) -> np.ndarray:
    """Ways (n, dim) of the particles of the upper body, so that rows of thin columns are in depth.

    Columns are those over the feet of the slant.
    """
    start = slant.foot[0]
    height = (position - start) @ slant.up
    below = slant.thickness[0] - (position - start) @ slant.normal
    across = position - height[:, None] * slant.up
    over_foot = cKDTree(slant.foot).query(across, distance_upper_bound=dp)[0] < dp
    thin = np.flatnonzero(over_foot & (below + height * slant.lean < THIN * dp))
    way = np.zeros_like(position)
    if not len(thin):
        return way
    across = across[thin]
    near = cKDTree(across).query_ball_point(across, COLUMN * dp)
    above = [(below[thin[each]] < below[k]).sum() for each, k in zip(near, thin, strict=True)]
    rise = (below[thin] - (np.array(above) + 0.5) * dp) / slant.lean
    way[thin] = rise[:, None] * slant.up
    return way


def _rows_above(slant: Slant, over: np.ndarray, deep: float, dp: float) -> np.ndarray:
    """How many rows (n,) of particles of the upper body are over those of the lower one.

    As far as that is less than `deep`, m.
    """
    tree, rows = cKDTree(over), np.zeros(len(slant.foot))
    left = np.arange(len(rows))
    while len(left):
        height = (slant.thickness[left] - (rows[left] + 0.5) * dp) / slant.lean
        place = slant.foot[left] + height[:, None] * slant.up
        there = (height > -0.5 * dp) & (tree.query(place)[0] < NEAR * dp)
        rows[left[there]] += 1
        left = left[there & (rows[left] * dp < deep)]
    return rows
