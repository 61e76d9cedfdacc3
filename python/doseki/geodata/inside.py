"""Which points lie inside a ring of vertices."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

ROUNDING = 1e-9  # of the length of a line, its width


def ring_area(ring: np.ndarray) -> float:
    """Area of a ring (n, 2), m2, above 0 where it runs counter-clockwise (shoelace formula)."""
    x, y = (ring - ring[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def is_line(ring: np.ndarray) -> bool:
    """Whether the vertices (n, 2) of a ring lie on a line, but for the rounding of coordinates."""
    length, width = np.linalg.svd(ring - ring.mean(axis=0), compute_uv=False)
    return bool(width <= ROUNDING * length)


def crossing_of(ring: np.ndarray) -> np.ndarray | None:
    """Where an edge of a ring (n, 2) crosses another one, (2,) m; None where none does.

    Edges that only touch, or lie along each other, do not cross.
    """
    start = ring - ring[0]
    along = np.roll(start, -1, axis=0) - start
    west, east = np.minimum(0, along[:, 0]) + start[:, 0], np.maximum(0, along[:, 0]) + start[:, 0]
    order = np.argsort(west, kind="stable")
    # Of the edges that begin farther east, those up to this place may meet each edge.
    last = np.searchsorted(west[order], east[order], side="right")
    for place, k in enumerate(order):
        others = order[place + 1 : last[place]]
        others = others[(np.abs(others - k) > 1) & (np.abs(others - k) < len(ring) - 1)]
        first, step = start[others], along[others]
        before = _turn(along[k], first - start[k])
        after = _turn(along[k], first + step - start[k])
        this_before = _turn(step, start[k] - first)
        this_after = _turn(step, start[k] + along[k] - first)
        found = np.flatnonzero((before * after < 0) & (this_before * this_after < 0))
        if len(found):
            j = found[0]
            share = before[j] / (before[j] - after[j])
            return np.asarray(ring[0] + first[j] + share * step[j])
    return None


def _turn(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])


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
