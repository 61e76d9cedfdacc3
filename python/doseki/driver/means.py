"""Gauges with means over the time between two samples."""

from __future__ import annotations

import math

from ..scenario.gauges.gauge import Rows, Sampled
from ..scenario.gauges.loads.metered import Metered
from .gauges import GaugeReader


class Means:
    """Makes means of the integrals that a gauge reads: what it was at the sample before."""

    def __init__(self, gauge: GaugeReader) -> None:
        self.gauge = gauge
        self._time = math.nan
        self._before: list[float] = []  # integrals at the last sample, row after row

    @property
    def state(self) -> list[float]:
        """What must be kept for it to go on to the same bits."""
        return [self._time, *self._before]

    @state.setter
    def state(self, state: list[float]) -> None:
        if not state or (len(state) - 1) % self.gauge.mean_columns:
            raise ValueError(f"the state of the gauge {self.gauge.name} has {len(state)} numbers")
        self._time, *self._before = state

    def sample(self, simulation: Sampled) -> Rows:
        """A sample; the means of the first one are nan. All ranks must take part."""
        count, rows = self.gauge.mean_columns, self.gauge.read(simulation)
        now = [integral for row in rows for integral in row[-count:]]
        before = self._before or [math.nan] * len(now)
        passed = simulation.time - self._time
        means = [(new - old) / passed for new, old in zip(now, before, strict=True)]
        self._time, self._before = simulation.time, now
        return [[*row[:-count], *means[k * count : (k + 1) * count]] for k, row in enumerate(rows)]


def build_means(gauges: list[GaugeReader]) -> dict[str, Means]:
    """One for each of the gauges that have means and no load meter, by name."""
    return {
        reader.name: Means(reader)
        for reader in gauges
        if reader.mean_columns and not isinstance(reader.gauge, Metered)
    }
