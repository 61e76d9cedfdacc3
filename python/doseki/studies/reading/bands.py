"""What percentiles over the runs are drawn of: tables [bands.NAME], and what runs keep for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field

from ...errors import UserError
from ...geodata.grid import Raster
from ...measure.views import fluid_names, select, whole_space
from ...record.reader import Run
from ...scenario.model import Scenario
from ...scenario.table import Table
from .kinds import Refuse, check_fluid, check_gauge, check_maps, check_one_row
from .results import MapName, map_of
from .series import gauge_series

CELL = 2.0  # spacings; of a profile
MOST_CELLS = 100_000


class Band(Table):
    """A quantity with a percentile at each place or time."""

    percent: list[float] = Field(
        [5.0, 50.0, 95.0], min_length=3, max_length=3, description="lowest, middle, highest"
    )
    max_score: float | None = Field(
        None, gt=0, description="runs with a higher score are left out; default: all runs count"
    )

    def objection(self) -> tuple[str, str] | None:
        """Percentages rise."""
        low, middle, high = self.percent
        if not 0 <= low < middle < high <= 100:
            return "percent", "must be three numbers that rise from 0 to 100"
        return None

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """Raise `refuse(key, reason)` where runs of the scenario do not have it."""


@dataclass(frozen=True)
class Curve:
    """Values (n,) at places or times (n,), with names and units for axes."""

    x: np.ndarray
    value: np.ndarray
    x_label: str
    label: str


class CurveBand(Band):
    """A band along a line: a function of time, or of a place."""

    def curve(self, run: Run) -> Curve:
        """That of a run."""
        raise NotImplementedError


class SeriesBand(CurveBand):
    """What a gauge reads over time: a level, the hydrograph of a section."""

    kind: Literal["series"]
    gauge: str = Field(description="[gauge.NAME] of the scenario")
    column: str = Field(description="of what the gauge reads")

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """The gauge and its column must be there, with one row for each time."""
        check_gauge(scenario, self.gauge, self.column, refuse)
        check_one_row(scenario, self.gauge, refuse)

    def curve(self, run: Run) -> Curve:
        """The series."""
        found = gauge_series(run, self.gauge, self.column)
        label = f"{self.gauge}: {self.column} ({found.unit})"
        return Curve(found.time, found.value, "time (s)", label)


class ProfileBand(CurveBand):
    """Depth of the flow along x in a section, a 2-D run, at a time."""

    kind: Literal["profile"]
    time: float = Field(ge=0, description="s; of the snapshot that is nearest")
    cell: float | None = Field(None, gt=0, description="m, along x; default: 2 dp")
    min: float = Field(description="x, m, where it begins")
    max: float = Field(description="x, m, where it ends")

    def objection(self) -> tuple[str, str] | None:
        """The ends are in order."""
        return super().objection() or (
            ("max", "must be greater than min") if self.max <= self.min else None
        )

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """A fluid in 2-D, a time that runs reach, cells that can be counted."""
        check_fluid(scenario, refuse)
        if scenario.dim != 2:
            raise refuse("kind", "a profile is one of a 2-D run; in 3-D take a map")
        if not scenario.begins_at <= self.time <= scenario.time_max:
            raise refuse("time", f"is outside of the runs, which end at {scenario.time_max:g} s")
        if (self.max - self.min) / (self.cell or CELL * scenario.dp) > MOST_CELLS:
            raise refuse("cell", f"makes more than {MOST_CELLS} cells")

    def curve(self, run: Run) -> Curve:
        """Depth by volume: that of the fluid over a cell, shared between cells by its width."""
        snapshot = run.at(self.time, nearest=True)
        there = select(snapshot, whole_space(2), fluid_names(run))
        volume = snapshot["mass"][there] / snapshot["density"][there]
        cell = self.cell or CELL * run.scenario["dp"]
        count = max(1, round((self.max - self.min) / cell))
        edges = np.linspace(self.min, self.max, count + 1)
        depth = shared(snapshot["position"][there, 0], np.sqrt(volume), volume, edges)
        depth /= np.diff(edges)
        label = f"depth at {snapshot.time:g} s (m)"
        return Curve(0.5 * (edges[1:] + edges[:-1]), depth, "x (m)", label)


class MapBand(Band):
    """A map of each percentile, and of how often a level is exceeded."""

    kind: Literal["map"]
    map: MapName = Field(description="a raster that runs keep")
    exceed: float | None = Field(
        None, ge=0, description="level whose probability of being exceeded is mapped"
    )

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """There must be maps."""
        check_maps(scenario, refuse)

    def raster(self, run: Run) -> Raster:
        """That of a run."""
        return map_of(run, self.map)


def shared(
    centre: np.ndarray, width: np.ndarray, amount: np.ndarray, edges: np.ndarray
) -> np.ndarray:
    """What lies between `edges` (n + 1,) of amounts (N,) spread evenly over their widths."""
    order = np.argsort(centre)
    centre, width, amount = centre[order], width[order], amount[order]
    below = np.empty(len(edges))
    for k, edge in enumerate(edges):
        below[k] = np.sum(amount * np.clip((edge - centre) / width + 0.5, 0.0, 1.0))
    return np.diff(below)


def read_curve(path: str, text: str) -> tuple[np.ndarray, np.ndarray]:
    """x and value (n,) as `curve_text` wrote them; raises UserError for anything else."""
    try:
        rows = [[float(cell) for cell in line.split(",")] for line in text.splitlines()[1:]]
        table = np.array(rows).reshape(len(rows), 2)
    except ValueError:
        raise UserError(f"{path}: is damaged") from None
    return table[:, 0], table[:, 1]


def curve_text(curve: Curve) -> str:
    """A curve as CSV."""
    rows = zip(curve.x, curve.value, strict=True)
    lines = [f"{curve.x_label},{curve.label}", *(f"{float(x)!r},{float(v)!r}" for x, v in rows)]
    return "\n".join(lines) + "\n"


BANDS: dict[str, type[Band]] = {"series": SeriesBand, "profile": ProfileBand, "map": MapBand}
