"""Fields of particles at places between them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .fraction import Cloud, weight

NEIGHBOURS = {2: 20, 3: 48}  # that are looked at
AT_ONCE = 200_000  # points


def interpolated(
    points: np.ndarray, cloud: Cloud, fields: Mapping[str, np.ndarray], kernel: str
) -> dict[str, np.ndarray]:
    """Fields at points (m, dim): means over the particles nearby, by volume and kernel (Shepard).

    `fields` hold a number or a vector for each particle of the cloud.
    """
    from scipy.spatial import cKDTree

    made = {k: np.zeros((len(points), *values.shape[1:])) for k, values in fields.items()}
    if not len(points):
        return made
    tree = cKDTree(cloud.position)
    nearest = min(NEIGHBOURS[cloud.dim], len(cloud.volume))
    for begin in range(0, len(points), AT_ONCE):
        part = slice(begin, begin + AT_ONCE)
        distance, index = tree.query(points[part], k=np.arange(1, nearest + 1))
        share = np.minimum(distance / cloud.reach[index], 1.0)
        scale = cloud.volume[index] / cloud.reach[index] ** cloud.dim
        weights = scale * weight(kernel, share, cloud.dim)
        weights[weights.sum(axis=1) == 0, 0] = 1.0  # out of reach of all: the nearest
        weights /= weights.sum(axis=1, keepdims=True)
        for key, values in fields.items():
            made[key][part] = np.einsum("pk,pk...->p...", weights, values[index])
    return made
