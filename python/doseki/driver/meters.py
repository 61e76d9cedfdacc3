"""Gauges that read the load meters of the core."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from ..scenario.gauges.gauge import Rows, Sampled
from ..scenario.gauges.loads.load import Load
from ..scenario.gauges.loads.standing_water import Known
from ..scenario.gauges.loads.surface import Box, surface_of
from .gauges import GaugeReader, MeterReader
from .means import Means

MARGIN = 1e-3  # spacings around the bodies, within which they are looked for


class LoadMeans:
    """Makes means of what a meter sums, and of the water that stands there at each sample."""

    def __init__(self, reader: MeterReader) -> None:
        self.gauge = reader
        self._load = cast(Load, reader.gauge)
        self._time = math.nan
        self._before: np.ndarray = np.zeros((0, 3))  # flow, contacts, standing water, as rows
        self._box: Box | None = None  # around the bodies
        self._moves = bool(reader.setting.moving & set(self._load.bodies))
        self._known = Known()  # of bodies that stand still

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
        row = self.gauge.row(simulation)
        box, known = self._box_around(simulation), None if self._moves else self._known
        static = self._load.static(simulation, setting, box, known)
        now = np.vstack([self._load.sums(row, setting.dim), static])
        if not len(self._before):
            self._before = np.full_like(now, math.nan)
        passed = simulation.time - self._time
        means = (now[:2] - self._before[:2]) / passed
        mean_static = 0.5 * (static + self._before[2])
        self._time, self._before = simulation.time, now
        self.gauge.forget_peak(simulation)
        return self._load.rows(simulation.time, row, mean_static, means)

    def _box_around(self, simulation: Sampled) -> Box:
        """That of bodies that stand still is found once."""
        setting = self.gauge.setting
        everywhere = np.full(setting.dim, math.inf)
        if self._moves:
            return -everywhere, everywhere
        if self._box is None:
            found = surface_of(simulation, setting, self._load.bodies, (-everywhere, everywhere))
            if not len(found.place):
                return -everywhere, everywhere
            # The particles lie up to a spacing below the surface.
            margin = (1 + MARGIN) * setting.dp
            self._box = found.place.min(axis=0) - margin, found.place.max(axis=0) + margin
        return self._box


def build_meters(gauges: list[GaugeReader]) -> dict[str, Means | LoadMeans]:
    """What makes means of a load meter, for each of the gauges that have one, by name."""
    return {
        reader.name: LoadMeans(reader) if isinstance(reader.gauge, Load) else Means(reader)
        for reader in gauges
        if isinstance(reader, MeterReader)
    }
