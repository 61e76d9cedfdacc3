"""Particles gathered in vertical columns over the cells of a map."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ...geodata.grid import Raster
from ...record.particles import BOUND, FREE


@dataclass(frozen=True)
class Columns:
    """What stands over the cells that hold anything.

    Attributes:
        cells: (n,) indices of the cells, row after row from the north, in ascending order.
        volume: (n,) m3.
        mass: (n,) kg.
        momentum: (n, 3) kg m/s.
        outside: volume beside the map, m3.

    """

    cells: np.ndarray
    volume: np.ndarray
    mass: np.ndarray
    momentum: np.ndarray
    outside: float


def columns_over(
    grid: Raster, state: Mapping[str, np.ndarray], slower_than: float = np.inf
) -> Columns:
    """Columns of what flows: free particles, and the points of bodies that move.

    `state` has fields of particles (N,) or (N, 3) as record.fields has them, in 3-D, at map
    coordinates. A particle counts as a cube of its volume, so where its square on the map meets
    several cells, each gets its share: volume, mass and momentum are kept. With `slower_than`, m/s,
    only particles below that speed count.
    """
    motion, velocity = state["motion"], state["velocity"]
    counts = (motion == FREE) | (motion == BOUND)
    if slower_than < np.inf:
        counts &= (velocity**2).sum(axis=1) < slower_than**2
    mass, velocity = state["mass"][counts], velocity[counts]
    volume = mass / state["density"][counts]
    side = np.minimum(np.cbrt(volume) / grid.cell, 1.0)  # in cells
    column = (state["position"][counts, 0] - grid.west) / grid.cell
    row = (grid.north - state["position"][counts, 1]) / grid.cell
    found = np.zeros((5, grid.values.size))
    added = np.stack([volume, mass, *(mass[:, None] * velocity).T])
    for (i, in_rows), (j, in_columns) in _pairs(_shares(row, side), _shares(column, side)):
        _add(found, grid.shape, i, j, added * (in_rows * in_columns))
    cells = np.flatnonzero(found[0] > 0)
    held = found[:, cells]
    outside = float(volume.sum() - held[0].sum())
    return Columns(cells, held[0], held[1], np.ascontiguousarray(held[2:].T), max(outside, 0.0))


Share = tuple[np.ndarray, np.ndarray]  # cells along an axis, and shares of particles in them


def _shares(position: np.ndarray, side: np.ndarray) -> tuple[Share, Share]:
    """The two cells that particles of width `side` meet along an axis; all in cells."""
    start = position - 0.5 * side
    first = np.floor(start)
    inside = np.minimum(1.0, (first + 1.0 - start) / side)
    cell = np.clip(first, -2.0, 2.0**31).astype(np.int64)
    return (cell, inside), (cell + 1, 1.0 - inside)


def _pairs(
    rows: tuple[Share, Share], columns: tuple[Share, Share]
) -> Iterator[tuple[Share, Share]]:
    return ((row, column) for row in rows for column in columns)


def _add(
    found: np.ndarray, shape: tuple[int, int], i: np.ndarray, j: np.ndarray, added: np.ndarray
) -> None:
    """Add what particles bring (5, N) to the cells (rows i, columns j) that are on the map."""
    on_map = (i >= 0) & (i < shape[0]) & (j >= 0) & (j < shape[1])
    cells = i[on_map] * shape[1] + j[on_map]
    for total, values in zip(found, added, strict=True):
        total += np.bincount(cells, values[on_map], minlength=len(total))
