"""Where grains come from: what was loose at the start, and what has come off structures."""

from __future__ import annotations

import numpy as np

from ...record.reader import Snapshot
from ..grading import is_structure


class Lineage:
    """Follows the grains of a run through its snapshots, in order of time."""

    def __init__(self, structures: set[str]) -> None:
        """`structures` are the names of the bodies that are clamped."""
        self._structures = structures
        self._first: np.ndarray | None = None  # ids of the grains of the first snapshot
        self._before = np.zeros(0, np.int64)  # and of the one before

    def look(self, snapshot: Snapshot, ids: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Take the grains `ids` (n,) of a snapshot: which are of the load; whence they came.

        The load (n,) bool is what was loose in the first snapshot, with all that comes off it; the
        rest has come off structures.  Whence is the id of the grain of the snapshot before that
        each is or was part of, -1: none.
        """
        self._first = ids if self._first is None else self._first
        first, before, self._before = self._first, self._before, ids
        parent = snapshot.grains.get("parent")
        if parent is None:
            return np.ones(len(ids), bool), np.where(np.isin(ids, before), ids, -1)
        parent = np.where(parent < len(parent), parent, -1).astype(np.int64)
        structure = is_structure(snapshot, self._structures)
        stop = structure.copy()
        stop[first] = True
        line = _nearest(parent, ids, stop)
        known = np.zeros(len(parent), bool)
        known[before] = True
        return (line < 0) | ~structure[line], _nearest(parent, ids, known)


def _nearest(parent: np.ndarray, ids: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """The first of the line of each row of `ids`, itself included, that is in a mask; -1: none."""
    found = ids.astype(np.int64)
    for _ in range(len(parent)):
        going = (found >= 0) & ~stop[found]
        if not going.any():
            return found
        found[going] = parent[found[going]]
    return np.where((found >= 0) & stop[found], found, -1)
