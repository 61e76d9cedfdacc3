"""The map of a terrain, of which each rank holds the part that it needs."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from ..scenario.bed import Bed

GROUND = 3  # tag; those of Transport are 1 and 2


class SharedGround:
    """Parts of the bed that rank 0 has, for all ranks."""

    def __init__(self, comm: MPI.Intracomm, bed: Bed | None) -> None:
        """`bed`: on rank 0."""
        self._comm, self._bed = comm, bed

    def part(self, wanted: list[float]) -> np.ndarray:
        """Heights, m, of some nodes, then 1 for each that is unknown; all ranks call it.

        `wanted` is the first node along each axis and how many, the first axis being the last of
        the bed's arrays; none where that is 0.
        """
        axes = len(wanted) // 2
        count = int(np.prod(wanted[axes:]))
        all_wanted = self._comm.gather(wanted)
        if all_wanted is None or self._bed is None:
            found = np.empty(2 * count)
            if count:
                self._comm.Recv(found, 0, GROUND)
            return found
        pending, mine = [], np.empty(0)
        for rank, part in enumerate(all_wanted):
            numbers = self._cut(part)
            if rank == self._comm.rank:
                mine = numbers
            elif len(numbers):
                pending.append(self._comm.Isend(numbers, rank, GROUND))
        MPI.Request.Waitall(pending)
        return mine

    def _cut(self, part: list[float]) -> np.ndarray:
        assert self._bed is not None
        axes = len(part) // 2
        ends = zip(part[:axes], part[axes:], strict=True)
        chosen = tuple(slice(int(first), int(first + count)) for first, count in ends)[::-1]
        if not all(part[axes:]):
            return np.empty(0)
        heights, unknown = self._bed.heights[chosen], self._bed.unknown[chosen]
        return np.concatenate([heights.ravel(), unknown.ravel().astype(np.float64)])
