"""Depth of a flow, from the volumes of its particles."""

from __future__ import annotations

import numpy as np


def column_depth(position: np.ndarray, volume: np.ndarray, cell: float) -> np.ndarray:
    """Depth (N,), m, of the flow where each particle is, along the last axis.

    It is the volume of the particles `position` (N, dim), m, of `volume` (N,), m3 (2-D: m2), in
    the square cell of side `cell`, m, over the area of that cell, without pores and gaps.
    """
    if not len(position):
        return np.zeros(0)
    node = np.floor(position[:, :-1] / cell).astype(np.int64)
    node -= node.min(axis=0)
    key = node[:, 0]
    for axis in range(1, node.shape[1]):
        key = key * (int(node[:, axis].max()) + 1) + node[:, axis]
    _, column = np.unique(key, return_inverse=True)
    area = cell ** node.shape[1]
    depth: np.ndarray = (np.bincount(column, volume) / area)[column]
    return depth
