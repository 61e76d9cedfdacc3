"""Cells of a map that stand far above or below all their neighbours, as holes written as 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..geodata.raster import Raster

CLIFF = 8.0  # cells of height over one cell, that no path leads over
SHEER = 50.0  # the same, where what stands apart is not 0


@dataclass(frozen=True)
class Islands:
    """Cells of a map that only cliffs join with the rest of it."""

    cells: int
    low: float  # m, the lowest of them
    high: float  # m
    jump: float  # m, the least to a neighbour
    place: tuple[float, float]  # m, of one of them


def islands_of(raster: Raster) -> Islands | None:
    """Those of a map that look like a number for no data, 0 or another; None without."""
    values = raster.values
    steps = [np.abs(np.diff(values, axis=axis)) for axis in (0, 1)]
    if max(float(np.nanmax(step, initial=0.0)) for step in steps) <= CLIFF * raster.cell:
        return None
    label = _labels(values, steps, CLIFF * raster.cell)
    jump = _least_jumps(label, steps)
    known = np.isfinite(values)
    main = np.bincount(label[known]).argmax()
    is_zero = np.ones(len(jump), bool)
    is_zero[label[known & (values != 0)]] = False
    doubtful = np.isfinite(jump) & (jump > np.where(is_zero, CLIFF, SHEER) * raster.cell)
    doubtful[main] = False
    cells = known & doubtful[label]
    if not cells.any():
        return None
    row, column = np.argwhere(cells)[0]
    place = (float(raster.x[column]), float(raster.y[row]))
    found, least = values[cells], float(jump[doubtful].min())
    return Islands(int(cells.sum()), float(found.min()), float(found.max()), least, place)


def _labels(values: np.ndarray, steps: list[np.ndarray], most: float) -> np.ndarray:
    """The number of the part of the map (rows, columns) that each cell is joined with."""
    number = np.arange(values.size).reshape(values.shape)
    pairs = [
        (first[step <= most], second[step <= most])
        for step, first, second in zip(
            steps, (number[:-1], number[:, :-1]), (number[1:], number[:, 1:]), strict=True
        )
    ]
    first, second = (np.concatenate(ends) for ends in zip(*pairs, strict=True))
    joined = coo_array((np.ones(len(first), np.int8), (first, second)), (values.size,) * 2)
    return np.asarray(connected_components(joined, directed=False)[1]).reshape(values.shape)


def _least_jumps(label: np.ndarray, steps: list[np.ndarray]) -> np.ndarray:
    """The least height (parts,) from each part to a neighbour in another one, m."""
    least = np.full(int(label.max()) + 1, np.inf)
    ends = ((label[:-1], label[1:]), (label[:, :-1], label[:, 1:]))
    for step, (first, second) in zip(steps, ends, strict=True):
        apart = (first != second) & np.isfinite(step)
        for side in (first, second):
            np.minimum.at(least, side[apart], step[apart])
    return least
