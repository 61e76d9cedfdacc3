"""How much ground comes with a flow that spreads: wall particles that are yet to be made."""

from __future__ import annotations

import math

import numpy as np

from ...record.particles import FIXED, FREE
from ...scenario.tables.terrain.terrain import TERRAIN
from .sliding import Sliding

LAYER = {2: 1.3, 3: 1.7}  # columns of ground that each particle has in a flow of one layer
ALONE = {2: 3.0, 3: 9.0}  # that one by itself has


def ground_to_come(
    sliding: Sliding, times: np.ndarray, entered: np.ndarray
) -> tuple[np.ndarray, float]:
    """Wall particles (n,) of a terrain beyond those of the start, at times, s; and at most.

    `entered` (n,) are particles that have come in by then.  A flow has as many columns of ground
    as points that slide come over, but no more than its particles have in one layer; at most it
    has as many as they have each by itself.
    """
    swept = sliding.swept
    if swept is None:
        return np.zeros(len(times)), 0.0
    scenario, state = sliding.scenario, sliding.state
    layers = math.ceil(scenario.support / scenario.dp - 1e-9)
    over = layers * (swept.cell / scenario.dp) ** (scenario.dim - 1) * swept.more(times)
    fluid = np.count_nonzero(state["motion"] == FREE) + entered
    is_ground = state["body"] == sliding.names.index(TERRAIN)
    there = np.count_nonzero(is_ground & (state["motion"] == FIXED))
    layer, alone = (
        np.clip(columns[scenario.dim] * layers * fluid - there, 0.0, over)
        for columns in (LAYER, ALONE)
    )
    return layer, float(alone.max())
