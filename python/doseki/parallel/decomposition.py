"""Cutting space into parts of equal weight, one for each rank."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from mpi4py import MPI

SAMPLES = 10_000  # points that a rank tells of, at most
ALL_SAMPLES = 2_000_000  # points from which space is cut, about


class Decomposition(Protocol):
    """Parts of space that fill it without overlap; part r belongs to rank r."""

    name: str

    def cut(self, points: np.ndarray, weights: np.ndarray) -> None:
        """Choose parts of equal weight.  Every rank gives its own points (n, dim) m, and their
        weights (n,); all ranks call it together.
        """

    def owners(self, points: np.ndarray) -> np.ndarray:
        """The ranks (n,) to which points (n, dim) belong."""

    def region(self) -> np.ndarray:
        """Low and high corner (2, dim) of a box that belongs to this rank, infinite at the rim."""

    def ranks_touching(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """The ranks of which a box holds some part, in order."""


class Multisection:
    """Slabs of equal weight along x, each cut along y, and those along z, from samples of the
    points (Makino 2004; Ishiyama, Fukushige & Makino 2009; as in FDPS, Iwasawa et al. 2016).
    """

    name = "multisection"

    def __init__(self, comm: MPI.Intracomm, dim: int) -> None:
        self._comm = comm
        self.counts = (comm.size,) + (1,) * (dim - 1)  # parts along each axis
        self.cuts = [np.zeros((int(np.prod(self.counts[:a])), n - 1)) for a, n in _numbered(self)]

    def cut(self, points: np.ndarray, weights: np.ndarray) -> None:
        """See Decomposition."""
        chosen, weight = sample(points, weights, min(SAMPLES, ALL_SAMPLES // self._comm.size + 1))
        samples = self._comm.gather((chosen, weight))
        found = None
        if samples is not None:
            everywhere = np.concatenate([part for part, _ in samples])
            weight = np.concatenate([part for _, part in samples])
            counts = best_counts(self._comm.size, np.ptp(everywhere, axis=0))
            found = counts, multisect(everywhere, weight, counts)
        self.counts, self.cuts = self._comm.bcast(found)

    def owners(self, points: np.ndarray) -> np.ndarray:
        """See Decomposition."""
        part = np.zeros(len(points), np.int64)
        for axis, n in _numbered(self):
            part = n * part + (self.cuts[axis][part] <= points[:, axis, None]).sum(axis=1)
        return part.astype(np.int32)

    def boxes(self) -> np.ndarray:
        """Low and high corner of every part, (ranks, 2, dim)."""
        boxes = np.empty((self._comm.size, 2, len(self.counts)))
        index = np.arange(self._comm.size)
        for axis, n in reversed(list(_numbered(self))):
            index, k = np.divmod(index, n)
            rim = np.full((len(self.cuts[axis]), 1), np.inf)
            edges = np.hstack([-rim, self.cuts[axis], rim])
            boxes[:, 0, axis], boxes[:, 1, axis] = edges[index, k], edges[index, k + 1]
        return boxes

    def region(self) -> np.ndarray:
        """See Decomposition."""
        return self.boxes()[self._comm.rank]

    def ranks_touching(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """See Decomposition."""
        boxes = self.boxes()
        return np.flatnonzero(np.all((boxes[:, 0] <= high) & (low < boxes[:, 1]), axis=1))


def _numbered(cuts: Multisection) -> Iterator[tuple[int, int]]:
    """Axes with the number of parts along each."""
    return iter(list(enumerate(cuts.counts)))


def sample(points: np.ndarray, weights: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray]:
    """At most `most` of the points, at equal steps of their cumulated weight, and their weights."""
    if len(points) <= most:
        return np.array(points), np.array(weights)
    total = np.cumsum(weights)
    chosen = np.searchsorted(total, (np.arange(most) + 0.5) * total[-1] / most)
    return points[chosen], np.full(most, total[-1] / most)


def best_counts(ranks: int, extent: np.ndarray) -> tuple[int, ...]:
    """Numbers of parts along each axis, `ranks` in all, that make for the least surface."""
    length = np.maximum(extent, 1e-3 * max(float(extent.max(initial=0.0)), 1e-300))
    every = _factorisations(ranks, len(extent))
    return min(every, key=lambda counts: (sum(np.array(counts) / length), counts))


def _factorisations(n: int, axes: int) -> list[tuple[int, ...]]:
    if axes == 1:
        return [(n,)]
    divisors = [k for k in range(1, n + 1) if n % k == 0]
    return [(k, *rest) for k in divisors for rest in _factorisations(n // k, axes - 1)]


def multisect(points: np.ndarray, weights: np.ndarray, counts: tuple[int, ...]) -> list[np.ndarray]:
    """Cuts along each axis: (1, nx - 1), (nx, ny - 1), (nx ny, nz - 1)."""
    cuts, part = [], np.zeros(len(points), np.int64)
    for axis, n in enumerate(counts):
        rows = int(np.prod(counts[:axis]))
        along = np.zeros((rows, n - 1))
        for row in range(rows):
            inside = part == row
            along[row] = quantiles(points[inside, axis], weights[inside], n)
        cuts.append(along)
        part = n * part + (along[part] <= points[:, axis, None]).sum(axis=1)
    return cuts


def quantiles(x: np.ndarray, weights: np.ndarray, n: int) -> np.ndarray:
    """The n - 1 places that divide points on a line into n groups of equal weight."""
    if len(x) == 0:
        return np.zeros(n - 1)
    order = np.argsort(x, kind="stable")
    x, total = x[order], np.cumsum(weights[order])
    last = np.searchsorted(total, total[-1] * np.arange(1, n) / n * (1 - 1e-12))
    return 0.5 * (x[last] + x[np.minimum(last + 1, len(x) - 1)])
