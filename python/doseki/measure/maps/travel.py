"""How far each particle has come, and at which angle below where it began."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ...geodata.grid import Raster
from ...record.particles import BOUND, FREE
from ...scene.periodic import nearest_image

# Of a state: rows of particles, in the order of their numbers.
ID, START, PLACE, LENGTH = "travel_id", "travel_start", "travel_place", "travel_length"
KEYS = (ID, START, PLACE, LENGTH)
Periods = Iterable[tuple[int, float, float]]


class Travel:
    """The way of every particle in plan, as straight lines between looks.

    Along a periodic axis a line is that to the nearest image.

    The travel angle of a particle is that of tan = (z0 - z) / s with the height z0 where it was
    first seen and the length s of its way on the map, as in AvaFrame (com1DFA). It counts from a
    way of one cell on: what has only just begun to fall has any angle.
    """

    def __init__(self, grid: Raster, periods: Periods = ()) -> None:
        """`periods`: each periodic axis with the ends of the domain, m."""
        self._grid = grid
        self._period = np.zeros(2)
        for axis, low, high in periods:
            if axis < 2:
                self._period[axis] = high - low
        self._id = np.zeros(0, np.int64)
        self._start = np.zeros(0)  # z0, m
        self._place = np.zeros((0, 2))  # where it was seen last, m
        self._length = np.zeros(0)  # m

    def look(self, state: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Take in the particles as they are now; returns cells (n,) and the largest angle of what
        is in them (n,), degrees.
        """
        counts = (state["motion"] == FREE) | (state["motion"] == BOUND)
        order = np.argsort(state["id"][counts], kind="stable")
        position = state["position"][counts][order]
        self._follow(state["id"][counts][order].astype(np.int64), position)
        far = self._length >= self._grid.cell
        fallen = self._start - position[:, 2]
        angle = np.degrees(np.arctan2(fallen[far], self._length[far]))
        row, column, on_map = self._grid.cells_at(*position[far, :2].T)
        on_map &= angle > 0
        cell = (row * self._grid.shape[1] + column)[on_map]
        cells, which = np.unique(cell, return_inverse=True)
        largest = np.zeros(len(cells))
        np.maximum.at(largest, which, angle[on_map])
        return cells, largest

    def _follow(self, numbers: np.ndarray, position: np.ndarray) -> None:
        """Add what each has gone since the last look; those who left are forgotten."""
        place = np.ascontiguousarray(position[:, :2])
        start, length = position[:, 2].copy(), np.zeros(len(numbers))
        at = np.searchsorted(self._id, numbers)
        known = at < len(self._id)
        known[known] = self._id[at[known]] == numbers[known]
        before = at[known]
        start[known] = self._start[before]
        step = nearest_image(place[known] - self._place[before], self._period)
        length[known] = self._length[before] + np.hypot(*step.T)
        self._id, self._start, self._place, self._length = numbers, start, place, length

    @property
    def state(self) -> dict[str, np.ndarray]:
        """What must be kept to go on to the same bits."""
        return dict(zip(KEYS, (self._id, self._start, self._place, self._length), strict=True))

    @state.setter
    def state(self, state: Mapping[str, np.ndarray]) -> None:
        """Raises ValueError for what is none."""
        numbers, start, place, length = (np.asarray(state[key]) for key in KEYS)
        if numbers.ndim != 1 or numbers.dtype.kind != "i" or (np.diff(numbers) <= 0).any():
            raise ValueError("the maps of the checkpoint have no list of particles")
        count = len(numbers)
        for name, shape in {START: (count,), PLACE: (count, 2), LENGTH: (count,)}.items():
            if state[name].shape != shape or not np.isfinite(state[name]).all():
                raise ValueError(f"the map's {name} of the checkpoint is damaged")
        if (length < 0).any():
            raise ValueError(f"the map's {LENGTH} of the checkpoint is damaged")
        self._id, self._start, self._place, self._length = numbers, start, place, length
