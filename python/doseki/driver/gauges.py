"""The gauges of a run, ready to be read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scenario.gauges.gauge import Gauge, Rows, Sampled, Setting, State
from ..scenario.model import Scenario


@dataclass(frozen=True)
class GaugeReader:
    """One gauge of a scenario, to be read from a core simulation."""

    name: str
    gauge: Gauge
    setting: Setting
    interval: float  # s

    @property
    def columns(self) -> dict[str, str]:
        """Name and unit of each column."""
        return self.gauge.columns(self.setting.dim)

    @property
    def header(self) -> list[str]:
        """The first line of its file."""
        return [f"{name} [{unit}]" for name, unit in self.columns.items()]

    @property
    def mean_columns(self) -> int:
        """How many of its last columns are means since the sample before."""
        return len(self.gauge.means(self.setting.dim))

    @property
    def counted_columns(self) -> int:
        """How many of its last columns count from the first sample."""
        return len(self.gauge.since_start(self.setting.dim))

    def read(self, simulation: Sampled) -> Rows:
        """A sample of the simulation as it is now; all ranks must take part."""
        return self.gauge.read(simulation, self.setting)


def build_gauges(scenario: Scenario, body_names: list[str]) -> list[GaugeReader]:
    """A reader for every gauge of the scenario."""
    setting = scenario.setting(body_names)
    return [
        GaugeReader(name, gauge, setting, scenario.interval_of(gauge))
        for name, gauge in scenario.gauge.items()
    ]


def outside_everything(scenario: Scenario, state: State) -> dict[str, np.ndarray]:
    """Places, m, of gauges that lie outside the box around all particles and inflow sections."""
    points = [state["position"], *(inflow.position[None, :] for inflow in scenario.inflow.values())]
    everything = np.concatenate(points)
    low, high = everything.min(axis=0) - scenario.dp, everything.max(axis=0) + scenario.dp
    places = {name: gauge.place for name, gauge in scenario.gauge.items()}
    return {
        name: place
        for name, place in places.items()
        if place is not None and (np.any(place < low) or np.any(place > high))
    }
