"""Points of which the neighbours tell a deformation."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from .balance import SUPPORT

# Determinant of the moment of the neighbours: 1 inside, 0.5 at a side, 0 where they lie in a line
# or plane.  With less than this, gradients would be so sharp that they set the time step.
LEAST = 0.02


def spanned(position: np.ndarray, spacing: float) -> np.ndarray:
    """Those of the positions (N, dim), m, whose neighbours among them span the space; may be none.

    By the moment of Eq. (80), the sum of V_j F R R over the neighbours.
    """
    while len(position):
        kept = _determinants(position, spacing) > LEAST
        if kept.all():
            break
        position = position[kept]
    return position


def _determinants(position: np.ndarray, spacing: float) -> np.ndarray:
    dim = position.shape[1]
    norm = 7 / math.pi if dim == 2 else 21 / (2 * math.pi)
    i, j = cKDTree(position).query_pairs(SUPPORT * spacing, output_type="ndarray").T
    apart = (position[i] - position[j]) / (SUPPORT * spacing)
    weight = 20 * norm / SUPPORT**dim * (1 - np.linalg.norm(apart, axis=1)) ** 3
    moment = np.zeros((len(position), dim, dim))
    for own in (i, j):
        np.add.at(moment, own, weight[:, None, None] * apart[:, :, None] * apart[:, None, :])
    return np.linalg.det(moment)
