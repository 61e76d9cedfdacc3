"""Gauges with a bandwidth: read at each step, whatever the interval at which they are recorded."""

from __future__ import annotations

import math

from ..scenario.gauges.gauge import Sampled
from ..util.low_pass import LowPass
from .gauges import GaugeReader


class Sensor:
    """What a sensor of limited bandwidth shows of its gauge, from step to step."""

    def __init__(self, gauge: GaugeReader, bandwidth: float) -> None:
        """`bandwidth` in Hz."""
        self.gauge = gauge
        self._filter = LowPass(bandwidth)
        self._time = self._raw = math.nan  # of the look before
        self._impulse, self._peak = 0.0, -float("inf")

    @property
    def state(self) -> list[float]:
        """What must be kept for it to go on to the same bits."""
        return [self._time, self._raw, self._impulse, self._peak, *self._filter.state]

    @state.setter
    def state(self, state: list[float]) -> None:
        if len(state) not in (4, 8):
            raise ValueError(f"the state of the gauge {self.gauge.name} has {len(state)} numbers")
        self._time, self._raw, self._impulse, self._peak, *of_filter = state
        self._filter.state = of_filter

    def follow(self, simulation: Sampled) -> None:
        """Look at the simulation as it is now; all ranks must take part."""
        ((time, raw),) = self.gauge.read(simulation)
        if not math.isnan(self._time):
            self._impulse += 0.5 * (time - self._time) * (raw + self._raw)
        self._time, self._raw = time, raw
        self._peak = max(self._peak, self._filter.add(time, raw))

    def row(self) -> list[float]:
        """A sample: the time, what it shows, its highest since the sample before, what there is
        without the filter, and the integral of that since the start.
        """
        shown, highest = self._filter.value, self._peak
        self._peak = shown
        return [self._time, shown, highest, self._raw, self._impulse]


def build_sensors(gauges: list[GaugeReader]) -> dict[str, Sensor]:
    """A sensor for each of the gauges that have a bandwidth, by name."""
    return {
        reader.name: Sensor(reader, reader.gauge.bandwidth)
        for reader in gauges
        if reader.gauge.bandwidth is not None
    }
