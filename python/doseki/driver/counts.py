"""Gauges that count from their first sample."""

from __future__ import annotations

from ..scenario.gauges.gauge import Rows, Sampled
from .gauges import GaugeReader


class Counts:
    """Takes off what a gauge counted at its first sample."""

    def __init__(self, gauge: GaugeReader) -> None:
        self.gauge = gauge
        self._first: list[float] = []

    @property
    def state(self) -> list[float]:
        """What must be kept for it to go on to the same bits."""
        return self._first

    @state.setter
    def state(self, state: list[float]) -> None:
        if len(state) != self.gauge.counted_columns:
            raise ValueError(f"the state of the gauge {self.gauge.name} has {len(state)} numbers")
        self._first = list(state)

    def sample(self, simulation: Sampled) -> Rows:
        """A sample; all ranks must take part."""
        count = self.gauge.counted_columns
        (row,) = self.gauge.read(simulation)
        self._first = self._first or row[-count:]
        counted = [now - first for now, first in zip(row[-count:], self._first, strict=True)]
        return [[*row[:-count], *counted]]


def build_counts(gauges: list[GaugeReader]) -> dict[str, Counts]:
    """One for each of the gauges that count from the start, by name."""
    return {reader.name: Counts(reader) for reader in gauges if reader.counted_columns}
