"""Gauges that count from their first sample."""

from __future__ import annotations

import numpy as np

from ..scenario.gauges.gauge import Rows, Sampled
from ..scenario.gauges.loads.overtopping import LOOKS, NOTHING, Beside
from ..solver.protocol import Simulation
from .gauges import GaugeReader, PlaneReader


class Counts:
    """Takes off what the gauge of a plane counted at its first sample, and follows what goes
    through the plane, to know where.
    """

    def __init__(self, gauge: PlaneReader) -> None:
        self.gauge = gauge
        self._first: list[float] = []
        self._seen: np.ndarray = NOTHING
        self._beside: Beside | None = None  # at the last look

    @property
    def state(self) -> list[float]:
        """What must be kept for it to go on to the same bits."""
        beside = [] if self._beside is None else self._beside.table.ravel().tolist()
        return [*self._first, *self._seen.tolist(), *beside]

    @state.setter
    def state(self, state: list[float]) -> None:
        counted, width = self.gauge.counted_columns, Beside.columns(self.gauge.setting.dim)
        known = counted + len(NOTHING)
        if len(state) < known or (len(state) - known) % width:
            raise ValueError(f"the state of the gauge {self.gauge.name} has {len(state)} numbers")
        self._first, self._seen = list(state[:counted]), np.array(state[counted:known])
        self._beside = Beside(np.array(state[known:]).reshape(-1, width))

    def follow(self, simulation: Simulation) -> None:
        """Look at the simulation after a step, if it is time; all ranks must take part.

        Bodies alone may go far in a step.
        """
        if self.gauge.setting.has_bodies_alone or simulation.steps % LOOKS == 0:
            self.look(simulation)

    def sample(self, simulation: Sampled) -> Rows:
        """A sample; all ranks must take part."""
        self.look(simulation)
        count = self.gauge.counted_columns
        (row,) = self.gauge.read(simulation, self._seen)
        self._first = self._first or row[-count:]
        counted = [now - first for now, first in zip(row[-count:], self._first, strict=True)]
        return [[*row[:-count], *counted]]

    def look(self, simulation: Sampled) -> None:
        """Take in what has gone through since the last look; all ranks must take part."""
        plane, setting = self.gauge.overtopping, self.gauge.setting
        now = plane.beside(simulation, setting)
        if self._beside is not None:
            self._seen = self._seen + plane.passed_between(self._beside, now, setting)
        self._beside = now


def build_counts(gauges: list[GaugeReader]) -> dict[str, Counts]:
    """One for each of the gauges that count from the start, by name."""
    return {reader.name: Counts(reader) for reader in gauges if isinstance(reader, PlaneReader)}
