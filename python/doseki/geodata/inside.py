"""Which points lie inside a ring of vertices."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np


def ring_area(ring: np.ndarray) -> float:
    """Area of a ring (n, 2), m2, above 0 where it runs counter-clockwise (shoelace formula)."""
    x, y = (ring - ring[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def inside_rings(rings: Iterable[np.ndarray], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which points are inside an odd number of rings (n, 2); arrays that broadcast.

    A ray to the east is counted where it meets edges (Shimrat 1962, Algorithm 112). An edge has
    its lower end and not its upper one, and is looked at from below whichever way it runs: so a
    point on an edge that two rings share is inside one of them.
    """
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    shape, x, y = x.shape, x.ravel(), y.ravel()
    order = np.argsort(y, kind="stable")
    x, y = x[order], y[order]
    odd = np.zeros(x.shape, dtype=bool)
    for ring in rings:
        for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            low, high = (start, end) if start[1] < end[1] else (end, start)
            part = slice(*np.searchsorted(y, (low[1], high[1])))
            side = (high[0] - low[0]) * (y[part] - low[1]) - (x[part] - low[0]) * (high[1] - low[1])
            odd[part] ^= side > 0
    found = np.empty_like(odd)
    found[order] = odd
    return found.reshape(shape)
