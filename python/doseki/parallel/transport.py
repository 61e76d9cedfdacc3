"""What the core asks of the other ranks, carried by MPI (the calls are those of core/exchange.hpp).

Arrays that come in are the core's own memory: nothing is copied on the way to MPI and back.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from mpi4py import MPI

from .balance import Balance
from .decomposition import Decomposition

HALO, PARCELS = 1, 2  # tags; parcels use two in turn


class Transport:
    """One rank's way to the others."""

    def __init__(
        self, comm: MPI.Intracomm, dim: int, decomposition: Decomposition, balance: Balance
    ) -> None:
        self.rank, self.ranks, self.dim = comm.rank, comm.size, dim
        self.decomposition, self.balance = decomposition, balance
        self._comm = comm
        self._pending: list[Any] = []
        self._swaps = 0
        self._crowded = is_crowded(comm)

    def largest(self, values: np.ndarray) -> None:
        """The largest of each value over all ranks, in place."""
        self._wait([self._comm.Iallreduce(MPI.IN_PLACE, values, MPI.MAX)])

    def sum(self, values: np.ndarray) -> None:
        """The sum of each value over all ranks, in place."""
        self._wait([self._comm.Iallreduce(MPI.IN_PLACE, values, MPI.SUM)])

    def gather(self, part: np.ndarray) -> np.ndarray:
        """The parts of all ranks one after another."""
        counts = np.empty(self.ranks, np.int64)
        self._wait([self._comm.Iallgather(np.array([len(part)]), counts)])
        everything = np.empty(counts.sum())
        self._wait([self._comm.Iallgatherv(part, (everything, counts))])
        return everything

    def swap(self, parcels: dict[int, np.ndarray]) -> dict[int, np.ndarray]:
        """Delivers bytes to the ranks that `parcels` names; gives what came, by rank.

        Nobody knows beforehand who will send: each rank joins a barrier once its parcels have been
        taken, and what is to come has come when all have (Hoefler, Siebert & Lumsdaine 2010).
        """
        comm, came, barrier = self._comm, {}, None
        # A rank that is ahead may already send parcels of the next swap.
        tag = PARCELS + self._swaps % 2
        self._swaps += 1
        sent = [comm.Issend([content, MPI.BYTE], rank, tag) for rank, content in parcels.items()]
        status = MPI.Status()
        while barrier is None or not barrier.Test():
            if comm.Iprobe(MPI.ANY_SOURCE, tag, status):
                content = np.empty(status.Get_count(MPI.BYTE), np.uint8)
                comm.Recv([content, MPI.BYTE], status.source, tag)
                came[status.source] = content
            elif barrier is None and MPI.Request.Testall(sent):
                barrier = comm.Ibarrier()
            elif self._crowded:
                os.sched_yield()
        return dict(sorted(came.items()))

    def wants_cuts(self, busy: float) -> bool:
        """Whether space is to be cut anew; see Balance."""
        return self.balance.is_due(busy)

    def cut(self, coordinates: np.ndarray, weights: np.ndarray) -> None:
        """Cuts space anew."""
        started = time.perf_counter()
        self.decomposition.cut(coordinates.reshape(-1, self.dim), weights)
        self.balance.has_cut(time.perf_counter() - started)

    def region(self) -> np.ndarray:
        """Low, then high corner of this rank's part."""
        return np.ascontiguousarray(self.decomposition.region(), np.float64).ravel()

    def owners(self, coordinates: np.ndarray) -> np.ndarray:
        """The ranks to which points belong."""
        return self.decomposition.owners(coordinates.reshape(-1, self.dim)).astype(np.int32)

    def start(
        self,
        peers: np.ndarray,
        send: np.ndarray,
        send_ends: np.ndarray,
        receive: np.ndarray,
        receive_ends: np.ndarray,
    ) -> None:
        """Begins to send to, and to receive from, each of `peers`; `ends` are in bytes."""
        for calls, buffer, ends in (
            (self._comm.Irecv, receive, receive_ends),
            (self._comm.Isend, send, send_ends),
        ):
            first = 0
            for peer, end in zip(peers.tolist(), ends.tolist(), strict=True):
                if end > first:
                    message = [buffer[first:end], MPI.BYTE]
                    self._pending.append(calls(message, peer, HALO))
                first = end

    def finish(self) -> None:
        """Returns once everything that was started is done."""
        self._wait(self._pending)
        self._pending.clear()

    def _wait(self, requests: Sequence[Any]) -> None:
        """Where ranks share cores, one that waits lets others work: MPI itself waits by looking."""
        while self._crowded and not MPI.Request.Testall(requests):
            os.sched_yield()
        MPI.Request.Waitall(requests)


def is_crowded(comm: MPI.Intracomm) -> bool:
    """Whether more ranks than cores are on this machine."""
    neighbours = comm.Split_type(MPI.COMM_TYPE_SHARED)
    crowded = neighbours.size > len(os.sched_getaffinity(0))
    neighbours.Free()
    return crowded
