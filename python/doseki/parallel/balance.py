"""When cutting space anew pays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mpi4py import MPI


class Balance:
    """Adds up what ranks lose by waiting for the busiest one, beyond what the last cut left, until
    that exceeds what the last cut took; then it is time for another.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self.cuts = 0
        self._lost = 0.0  # s
        self._cost = 0.0  # s, of the last cut
        self._left: float | None = 0.0  # imbalance that the last cut left; None: not yet known

    def is_due(self, busy: float) -> bool:
        """Whether to cut now; `busy`: seconds that this rank has worked since the last call.

        All ranks call it together, and get the same answer.
        """
        from mpi4py import MPI

        if self.cuts == 0:
            return True
        worst = np.array([busy, self._cost])
        total = np.array([busy])
        self._comm.Allreduce(MPI.IN_PLACE, worst, MPI.MAX)
        self._comm.Allreduce(MPI.IN_PLACE, total, MPI.SUM)
        mean = total[0] / self._comm.size
        excess = worst[0] - mean
        if self._left is None:
            self._left = excess / mean if mean > 0 else 0.0
            return False
        self._lost += max(0.0, excess - self._left * mean)
        return bool(self._lost > worst[1])

    def has_cut(self, seconds: float) -> None:
        """A cut was made, which took that long."""
        self.cuts += 1
        self._lost, self._cost = 0.0, seconds
        # The first cut takes all particles for equal; the next one knows their costs.
        self._left = None if self.cuts > 1 else 0.0
