"""Cells of a map that stand far above or below all their neighbours, as holes written as 0."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..geodata.raster import Raster

CLIFF = 8.0  # cells of height over one cell, that no path leads over
SHEER = 50.0  # the same, where what stands apart is not 0
LARGE = 0.02  # of the map: as a sea under a quay, or the floor of a flume
TALL = 50.0  # m, that what is large and 0 must stand apart
NOWHERE = 1e9  # m, in place of heights that are not known
MAX_CELLS = 20_000_000  # of a map to look at; they take 0.5 GB meanwhile
MAX_RUNS = 1_000_000  # of it; a map with more is rough all over


@dataclass(frozen=True)
class Islands:
    """Cells of a map that only cliffs join with the rest of it."""

    cells: int
    low: float  # m, the lowest of them
    high: float  # m
    jump: float  # m, the least to a neighbour
    place: tuple[float, float]  # m, of one of them


class _Runs(NamedTuple):
    """Stretches of rows of a map without a cliff."""

    first: np.ndarray  # (runs,) flat index of the first cell
    of_cell: np.ndarray  # (rows, columns) which of them a cell is in
    part: np.ndarray  # (runs,) of the map, that cliffs bound


def islands_of(raster: Raster) -> Islands | None:
    """Those of a map that look like a number for no data, 0 or another; None without.

    Parts that are large may be 0 and stand apart as water does at a quay.
    """
    heights = np.where(np.isfinite(raster.values), raster.values, NOWHERE)
    cliffs = [np.abs(np.diff(heights, axis=axis)) > CLIFF * raster.cell for axis in (0, 1)]
    if not any(cliff.any() for cliff in cliffs):
        return None
    runs = _runs(cliffs)
    return None if runs is None else _doubtful(raster, heights, cliffs, runs)


def _doubtful(
    raster: Raster, heights: np.ndarray, cliffs: list[np.ndarray], runs: _Runs
) -> Islands | None:
    """Parts that stand apart as no ground does."""
    lowest, highest = (
        each.reduceat(heights.ravel(), runs.first) for each in (np.minimum, np.maximum)
    )
    known = lowest < NOWHERE
    length = np.diff(runs.first, append=heights.size)
    jump = _least_jumps(heights, cliffs, runs)
    size = np.bincount(runs.part, np.where(known, length, 0))
    is_zero = np.ones(len(jump), bool)
    is_zero[runs.part[(lowest != 0) | (highest != 0)]] = False
    least = np.where(is_zero, CLIFF, SHEER) * raster.cell
    is_large = size > LARGE * size.sum()
    least[is_large] = np.where(is_zero, np.maximum(SHEER * raster.cell, TALL), np.inf)[is_large]
    doubtful = np.isfinite(jump) & (jump > least)
    doubtful[size.argmax()] = False
    found = known & doubtful[runs.part]
    if not found.any():
        return None
    row, column = np.unravel_index(runs.first[found][0], heights.shape)
    return Islands(
        int(length[found].sum()),
        float(lowest[found].min()),
        float(highest[found].max()),
        float(jump[doubtful].min()),
        (float(raster.x[column]), float(raster.y[row])),
    )


def _runs(cliffs: list[np.ndarray]) -> _Runs | None:
    """The runs of a map with these cliffs from row to row, and along rows; None if too many."""
    down, along = cliffs
    begins = np.ones((len(along), down.shape[1]), bool)
    begins[:, 1:] = along
    first = np.flatnonzero(begins)
    if len(first) > MAX_RUNS:
        return None
    of_cell = (np.cumsum(begins.ravel(), dtype=np.int32) - 1).reshape(begins.shape)
    # Runs of two rows are joined where the first cells of a stretch are that they share.
    joined = ~down
    joined[:, 1:] &= down[:, :-1] | along[:-1] | along[1:]
    ends = of_cell[:-1][joined], of_cell[1:][joined]
    graph = coo_array((np.ones(len(ends[0]), np.int8), ends), (len(first),) * 2)
    return _Runs(first, of_cell, connected_components(graph, directed=False)[1])


def _least_jumps(heights: np.ndarray, cliffs: list[np.ndarray], runs: _Runs) -> np.ndarray:
    """The least height (parts,) from each part to a known neighbour in another one, m."""
    least = np.full(int(runs.part.max()) + 1, np.inf)
    for axis, cliff in enumerate(cliffs):
        one = np.flatnonzero(cliff)
        one = np.ravel_multi_index(np.unravel_index(one, cliff.shape), heights.shape)
        other = one + (heights.shape[1] if axis == 0 else 1)
        step = np.abs(heights.flat[one] - heights.flat[other])
        parts = [runs.part[runs.of_cell.flat[ends]] for ends in (one, other)]
        apart = (parts[0] != parts[1]) & (step < 0.5 * NOWHERE)
        for part in parts:
            np.minimum.at(least, part[apart], step[apart])
    return least
