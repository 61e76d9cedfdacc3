"""Which of many boxes meet."""

from __future__ import annotations

import numpy as np


def meeting_pairs(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Pairs (m, 2) of the boxes from `low` (n, dim) to `high` (n, dim) that meet, smaller first.

    In the order of their first and then of their second number. A sweep along x.
    """
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    ends = np.searchsorted(low[:, 0], high[:, 0], side="right")
    found = [np.empty((0, 2), np.int64)]
    for k, end in enumerate(ends):
        later = slice(k + 1, end)
        meets = ((low[later] <= high[k]) & (low[k] <= high[later])).all(axis=1)
        second = np.flatnonzero(meets) + k + 1
        found.append(np.stack([np.full(len(second), k), second], axis=1))
    pairs = np.sort(order[np.concatenate(found)], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]
