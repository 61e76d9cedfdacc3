"""What a flow has been at most in each cell of a map, and when it came."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...geodata.grid import Raster
from .columns import Columns, columns_over
from .quantities import (
    ARRIVAL_TIME,
    PEAK_DEPTH,
    PEAK_MOMENTUM_FLUX,
    PEAK_PRESSURE,
    PEAK_SPEED,
    PEAK_TOTAL_PRESSURE,
    PEAK_TRAVEL_ANGLE,
    REMEMBERED,
)
from .travel import KEYS as TRAVEL
from .travel import Periods, Travel

CELLS, OUTSIDE = "cells", "outside"  # of a state, beside the quantities


class Peaks:
    """The largest of each quantity over all looks so far, by cell.

    Depth is the volume of a column over the area of its cell, speed the length of the velocity of
    its centre of mass. The weight on the bed is rho g h cos2 of its slope: that of a layer of
    vertical depth h on an infinite slope. Cells below `min_depth` do not count.
    """

    def __init__(
        self, grid: Raster, min_depth: float, gravity: float, periods: Periods = ()
    ) -> None:
        """`min_depth` in m; `gravity` in m/s2; `periods` as Travel takes them."""
        self.grid, self.min_depth, self._gravity = grid, min_depth, gravity
        self._cos2 = cos2_of_slope(grid).ravel()
        size = grid.values.size
        self.values = {quantity.name: np.zeros(size) for quantity in REMEMBERED}
        self.values[ARRIVAL_TIME.name].fill(np.nan)
        self.outside = 0.0  # largest share of the volume that was beside the map
        self._travel = Travel(grid, periods)

    def look(self, time: float, state: Mapping[str, np.ndarray]) -> None:
        """Take in the particles at a time, s."""
        columns = columns_over(self.grid, state)
        total = columns.volume.sum() + columns.outside
        if total > 0:
            self.outside = max(self.outside, float(columns.outside / total))
        self._take(time, columns)
        cells, angle = self._travel.look(state)
        reached = ~np.isnan(self.values[ARRIVAL_TIME.name][cells])
        steepest = self.values[PEAK_TRAVEL_ANGLE.name]
        steepest[cells[reached]] = np.maximum(steepest[cells[reached]], angle[reached])

    def _take(self, time: float, columns: Columns) -> None:
        depth = columns.volume / self.grid.cell**2
        deep = depth >= self.min_depth
        cells, depth = columns.cells[deep], depth[deep]
        mass = columns.mass[deep]
        density = mass / columns.volume[deep]
        square = ((columns.momentum[deep] / mass[:, None]) ** 2).sum(axis=1)
        weight = density * self._gravity * depth * self._cos2[cells]
        found = {
            PEAK_DEPTH: depth,
            PEAK_SPEED: np.sqrt(square),
            PEAK_PRESSURE: density * square,
            PEAK_TOTAL_PRESSURE: density * square + weight,
            PEAK_MOMENTUM_FLUX: depth * square,
        }
        for quantity, values in found.items():
            largest = self.values[quantity.name]
            largest[cells] = np.maximum(largest[cells], values)
        arrival = self.values[ARRIVAL_TIME.name]
        new = cells[np.isnan(arrival[cells])]
        arrival[new] = time

    @property
    def state(self) -> dict[str, np.ndarray]:
        """What must be kept to go on to the same bits: of the cells that were reached alone."""
        cells = np.flatnonzero(~np.isnan(self.values[ARRIVAL_TIME.name]))
        kept = {name: values[cells] for name, values in self.values.items()}
        return {CELLS: cells, OUTSIDE: np.array([self.outside])} | kept | self._travel.state

    @state.setter
    def state(self, state: Mapping[str, np.ndarray]) -> None:
        """Raises ValueError for the state of another map."""
        names = {CELLS, OUTSIDE, *self.values, *TRAVEL}
        if set(state) != names:
            raise ValueError("the maps of the scenario are not those of its checkpoint")
        cells = state[CELLS]
        size = self.grid.values.size
        if cells.ndim != 1 or cells.dtype.kind != "i" or state[OUTSIDE].shape != (1,):
            raise ValueError("the maps of the checkpoint have no list of cells")
        if len(cells) and not (cells.min() >= 0 and cells.max() < size):
            raise ValueError("the maps of the checkpoint have cells beside the terrain")
        for name, values in self.values.items():
            kept = state[name]
            if kept.shape != cells.shape or not np.isfinite(kept).all():
                raise ValueError(f"the map {name} of the checkpoint is damaged")
            values.fill(np.nan if name == ARRIVAL_TIME.name else 0.0)
            values[cells] = kept
        self.outside = float(state[OUTSIDE][0])
        self._travel.state = {name: state[name] for name in TRAVEL}

    def map_of(self, name: str) -> np.ndarray:
        """A quantity on the cells (rows, cols); 0 where nothing came, of arrival times NaN."""
        return self.values[name].reshape(self.grid.shape)


def deposit(
    grid: Raster, state: Mapping[str, np.ndarray], speed: float, depth: float
) -> np.ndarray:
    """Depth (rows, cols), m, of particles slower than `speed`, m/s; 0 where it is below `depth`."""
    columns = columns_over(grid, state, slower_than=speed)
    found = np.zeros(grid.values.size)
    found[columns.cells] = columns.volume / grid.cell**2
    found[found < depth] = 0.0
    return found.reshape(grid.shape)


def beside_deposit(
    grid: Raster, state: Mapping[str, np.ndarray], speed: float, depth: float
) -> dict[str, float]:
    """Volumes, m3, that are in no cell of such a deposit, by why: what is faster than `speed`, m/s,
    what lies in cells below `depth`, m, and what lies beside the map.
    """
    everything, slow = columns_over(grid, state), columns_over(grid, state, slower_than=speed)
    total, lying = (float(c.volume.sum()) + c.outside for c in (everything, slow))
    thin = slow.volume[slow.volume / grid.cell**2 < depth]
    return {"moving": max(total - lying, 0.0), "thin": float(thin.sum()), "beside": slow.outside}


def cos2_of_slope(bed: Raster) -> np.ndarray:
    """Squared cosine (rows, cols) of the inclination of the bed; 1 where that is not known."""
    square = np.zeros(bed.shape)
    for axis in (0, 1):
        if bed.shape[axis] > 1:
            square += np.nan_to_num(np.gradient(bed.values, bed.cell, axis=axis)) ** 2
    return 1.0 / (1.0 + square)


def gravity_of(gravity: np.ndarray) -> float:
    """Its vertical part, m/s2, that presses a column on its bed."""
    return float(max(-gravity[-1], 0.0)) if math.isfinite(gravity[-1]) else 0.0
