"""Maps that are kept while a run goes on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..measure.maps.files import rasters_of, write_maps
from ..measure.maps.grid import MapSettings, few_particles, map_grid
from ..measure.maps.peaks import Peaks, beside_deposit, gravity_of
from ..measure.maps.runout import runout
from ..measure.maps.standing import clamped_bodies, flowing
from ..record.folder import RunFolder
from ..scenario.model import Scenario
from ..solver.protocol import Simulation
from ..util.finding import Finding, percent
from .ranks import OneRank
from .schedule import OutputTimes

LOST = 0.01  # share of the volume beside the map from which on it is told


@dataclass(frozen=True)
class SmallCells(Finding):
    """Cells of a map that hold hardly a particle."""

    why: str

    def __str__(self) -> str:
        return f"{self.place}: {self.why}"


class RunningMaps:
    """The maps of a run: rank 0 has them, all ranks give it their particles."""

    def __init__(
        self, scenario: Scenario, body_names: list[str], folder: RunFolder, ranks: OneRank
    ) -> None:
        """Raises UserError where the run's grid cannot be used."""
        assert scenario.maps is not None
        tables = {k: body.model_dump(exclude_none=True) for k, body in scenario.body.items()}
        self._clamped = clamped_bodies(body_names, tables)
        table = scenario.maps.model_dump(exclude_none=True)
        self.settings = MapSettings.of(table, scenario.dp)
        self.times = OutputTimes(scenario.maps.interval or scenario.time_out, scenario.time_max)
        self._folder, self._ranks = folder, ranks
        self._peaks: Peaks | None = None
        self.runout: dict[str, Any] | None = None  # as written last, on rank 0
        self._warning = ranks.on_root(lambda: self._begin(scenario))

    def _begin(self, scenario: Scenario) -> str | None:
        grid = map_grid(self._folder, self.settings)
        gravity, periods = gravity_of(scenario.gravity), scenario.setting().periods()
        self._peaks = Peaks(grid, self.settings.dry_below, gravity, periods)
        return few_particles(grid, self.settings.dp)

    @property
    def findings(self) -> list[Finding]:
        """What is doubtful about them before the run."""
        return [SmallCells("maps", self._warning)] if self._warning else []

    @property
    def remarks(self) -> list[str]:
        """What is doubtful about them after it, on rank 0."""
        peaks = self._peaks
        if peaks is None or peaks.outside < LOST:
            return []
        return [
            f"maps: up to {percent(peaks.outside)} of the volume was beside the map; a larger"
            " extent, or a larger terrain, would show it"
        ]

    def look(self, simulation: Simulation) -> None:
        """Take in the particles as they are now; all ranks must take part."""
        state = simulation.state()
        if self._peaks is not None:
            self._peaks.look(simulation.time, flowing(state, self._clamped))

    def write(self, simulation: Simulation) -> None:
        """Write the maps so far, and the deposit as it is now; all ranks must take part."""
        state, time = simulation.state(), simulation.time
        self._ranks.on_root(lambda: self._write(state, time))

    def _write(self, state: Mapping[str, np.ndarray], time: float) -> None:
        assert self._peaks is not None
        grid, settings, flow = self._peaks.grid, self.settings, flowing(state, self._clamped)
        rasters = rasters_of(self._peaks, flow, settings)
        write_maps(self._folder, rasters, settings, time)
        beside = beside_deposit(grid, flow, settings.speed_deposit, settings.dry_below)
        found = runout(rasters, grid, settings.speed_deposit)
        self.runout = asdict(replace(found, beside_deposit=beside))

    @property
    def state(self) -> dict[str, np.ndarray]:
        """What must be kept to go on to the same bits; empty beyond rank 0."""
        return {} if self._peaks is None else self._peaks.state

    def go_on_from(self, state: Mapping[str, np.ndarray]) -> None:
        """Take what a checkpoint kept; raises ValueError for that of another map."""
        if self._peaks is not None:
            self._peaks.state = dict(state)
