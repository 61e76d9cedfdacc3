"""The gauges of a run, ready to be read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol, cast

import numpy as np

from ..scenario.gauges.gauge import Gauge, Rows, Sampled, Setting, State
from ..scenario.gauges.loads.force import Force
from ..scenario.gauges.loads.load import Load
from ..scenario.gauges.loads.overtopping import NOTHING, Overtopping
from ..scenario.gauges.loads.panels import Panels
from ..scenario.model import Scenario
from ..solver.faces import faces_of


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


class WithMeters(Sampled, Protocol):
    """A simulation that has load meters; see solver.protocol.Simulation."""

    def loads(self) -> Mapping[str, np.ndarray]:
        """What they have summed."""

    def forget_load_peak(self, meter: int) -> None:
        """The peak of one is that from now on."""


@dataclass(frozen=True)
class MeterReader(GaugeReader):
    """One that reads a load meter of the core."""

    meter: int  # its number

    def row(self, simulation: Sampled) -> dict[str, np.ndarray]:
        """What the meter has summed, by the keys of solver.protocol.Loads."""
        table = cast(WithMeters, simulation).loads()
        ends = np.cumsum(table["panels"])
        own = slice(int(ends[self.meter] - table["panels"][self.meter]), int(ends[self.meter]))
        return {
            key: values[own] if key.startswith("panel_") else values[self.meter]
            for key, values in table.items()
        }

    def forget_peak(self, simulation: Sampled) -> None:
        """The peak of the meter is that from now on."""
        cast(WithMeters, simulation).forget_load_peak(self.meter)

    def read(self, simulation: Sampled) -> Rows:
        """A sample; in place of means the integrals since the start."""
        row, setting = self.row(simulation), self.setting
        if isinstance(self.gauge, Load):
            far = np.full(setting.dim, np.inf)
            static = self.gauge.static(simulation, setting, (-far, far))
            return self.gauge.rows(simulation.time, row, static, self.gauge.sums(row, setting.dim))
        if isinstance(self.gauge, Force):
            return self.gauge.rows(simulation, setting, row)
        return cast(Panels, self.gauge).rows(simulation.time, row)


@dataclass(frozen=True)
class PlaneReader(GaugeReader):
    """One that reads a plane of the core at which crossings are counted."""

    plane: int  # its number

    @property
    def overtopping(self) -> Overtopping:
        """The gauge."""
        return cast(Overtopping, self.gauge)

    def read(self, simulation: Sampled, seen: np.ndarray = NOTHING) -> Rows:
        """A sample; `seen` is what was seen to go over the crest.  All ranks must take part."""
        return self.overtopping.rows(simulation, self.setting, self.plane, seen)


def build_gauges(scenario: Scenario, body_names: list[str]) -> list[GaugeReader]:
    """A reader for every gauge of the scenario."""
    setting = replace(scenario.setting(body_names), faces=faces_of(scenario))
    readers = list[GaugeReader]()
    for name, gauge in scenario.gauge.items():
        known = name, gauge, setting, scenario.interval_of(gauge)
        if name in scenario.metered:
            readers.append(MeterReader(*known, scenario.metered.index(name)))
        elif name in scenario.crossed:
            readers.append(PlaneReader(*known, scenario.crossed.index(name)))
        else:
            readers.append(GaugeReader(*known))
    return readers


def outside_everything(scenario: Scenario, state: State) -> dict[str, np.ndarray]:
    """Places, m, of gauges outside the box around all particles, inflow sections and ground."""
    points = [state["position"], *(inflow.position[None, :] for inflow in scenario.inflow.values())]
    if scenario.bed is not None:
        points.append(np.array(scenario.bed.corners))
    everything = np.concatenate(points)
    low, high = everything.min(axis=0) - scenario.dp, everything.max(axis=0) + scenario.dp
    return {
        name: gauge.place
        for name, gauge in scenario.gauge.items()
        if gauge.place is not None and gauge.is_outside(low, high, scenario.gravity)
    }
