"""Gauges that read the load meters of the core."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np

from ..scenario.gauges.gauge import Rows, Sampled
from ..scenario.gauges.loads.load import Load
from ..scenario.gauges.loads.panels import Panels
from ..scenario.gauges.loads.standing_water import Box, surface_of
from .gauges import GaugeReader
from .means import Means

MARGIN = 1e-3  # spacings around the bodies, within which they are looked for


class WithMeters(Sampled, Protocol):
    """A simulation that has load meters; see solver.protocol.Simulation."""

    def loads(self) -> Mapping[str, np.ndarray]:
        """What they have summed."""

    def forget_load_peak(self, meter: int) -> None:
        """The peak of one is that from now on."""


def meter_row(simulation: Sampled, meter: int) -> dict[str, np.ndarray]:
    """What one meter has summed, by the keys of solver.protocol.Loads."""
    table = cast(WithMeters, simulation).loads()
    ends = np.cumsum(table["panels"])
    own = slice(int(ends[meter] - table["panels"][meter]), int(ends[meter]))
    return {
        key: values[own] if key.startswith("panel_") else values[meter]
        for key, values in table.items()
    }


@dataclass(frozen=True)
class PanelReader(GaugeReader):
    """Reads the panels of a meter."""

    meter: int

    def read(self, simulation: Sampled) -> Rows:
        """A row for each panel; in place of means the integrals since the start."""
        row = meter_row(simulation, self.meter)
        return cast(Panels, self.gauge).rows(simulation.time, row)


class LoadMeans:
    """Makes means of what a meter sums, and of the water that stands there at each sample."""

    def __init__(self, reader: GaugeReader, meter: int) -> None:
        self.gauge, self.meter = reader, meter
        self._load = cast(Load, reader.gauge)
        self._time = math.nan
        self._before: np.ndarray = np.zeros((0, 3))  # flow, contacts, standing water, as rows
        self._box: Box | None = None  # around the bodies

    @property
    def state(self) -> list[float]:
        """What must be kept for it to go on to the same bits."""
        return [self._time, *self._before.ravel().tolist()]

    @state.setter
    def state(self, state: list[float]) -> None:
        numbers = 3 * (3 if self.gauge.setting.dim == 2 else 6)
        if len(state) != 1 + numbers:
            raise ValueError(f"the state of the gauge {self.gauge.name} has {len(state)} numbers")
        self._time = state[0]
        self._before = np.array(state[1:]).reshape(3, -1)

    def sample(self, simulation: Sampled) -> Rows:
        """A sample; the means of the first one are nan. All ranks must take part."""
        setting = self.gauge.setting
        row = meter_row(simulation, self.meter)
        static = self._load.static(simulation, setting, self._box_around(simulation))
        now = np.vstack([self._load.sums(row, setting.dim), static])
        if not len(self._before):
            self._before = np.full_like(now, math.nan)
        passed = simulation.time - self._time
        means = (now[:2] - self._before[:2]) / passed
        mean_static = 0.5 * (static + self._before[2])
        self._time, self._before = simulation.time, now
        cast(WithMeters, simulation).forget_load_peak(self.meter)
        return self._load.rows(simulation.time, row, mean_static, means)

    def _box_around(self, simulation: Sampled) -> Box:
        """That of bodies that stand still is found once."""
        setting = self.gauge.setting
        everywhere = np.full(setting.dim, math.inf)
        if setting.moving & set(self._load.bodies):
            return -everywhere, everywhere
        if self._box is None:
            found = surface_of(simulation, setting, self._load.bodies, (-everywhere, everywhere))
            if not len(found.place):
                return -everywhere, everywhere
            # The particles lie up to a spacing below the surface.
            margin = (1 + MARGIN) * setting.dp
            self._box = found.place.min(axis=0) - margin, found.place.max(axis=0) + margin
        return self._box


def build_meters(gauges: list[GaugeReader], metered: list[str]) -> dict[str, Means | LoadMeans]:
    """A reader of its meter for each of the gauges that have one, by name."""
    made: dict[str, Means | LoadMeans] = {}
    for reader in gauges:
        if reader.name not in metered:
            continue
        meter = metered.index(reader.name)
        if isinstance(reader.gauge, Panels):
            fields = reader.name, reader.gauge, reader.setting, reader.interval
            made[reader.name] = Means(PanelReader(*fields, meter))
        else:
            made[reader.name] = LoadMeans(reader, meter)
    return made
