"""What is read of each run, a number each: tables [result.NAME]."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from ...errors import UserError
from ...geodata.errors import GeodataError
from ...geodata.grid import Raster
from ...measure.loads import WINDOWS, body_loads
from ...measure.maps.files import reached, read_maps
from ...measure.maps.grid import MapSettings, cells_of
from ...measure.maps.quantities import ARRIVAL_TIME, QUANTITIES
from ...record.history import history_unit
from ...record.reader import Run
from ...scenario.gauges.loads.load import Load
from ...scenario.model import Scenario
from ...scenario.table import Table
from .kinds import Refuse, check_fluid, check_gauge, check_history, check_maps, check_one_row
from .series import (
    REDUCTIONS,
    Reduced,
    front_series,
    gauge_series,
    history_series,
    time_of_front,
)

MAPS = {quantity.name: quantity for quantity in QUANTITIES}
MapName = Literal[
    "peak_depth", "peak_speed", "peak_pressure", "peak_total_pressure", "peak_momentum_flux",
    "peak_travel_angle", "arrival_time", "deposit",
]  # fmt: skip
RUN_OUT = {
    "distance": "m", "angle": "degrees", "area": "m2", "deposit_area": "m2", "deposit_volume": "m3",
}  # fmt: skip


class Result(Table):
    """A number that each run has."""

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """Raise `refuse(key, reason)` where runs of the scenario do not have it."""

    def unit(self, scenario: Scenario) -> str:
        """Its unit; empty for plain numbers."""
        return ""

    def read(self, run: Run) -> float:
        """The number; nan where the run has none, as the time of what never came."""
        raise NotImplementedError


class OfHistory(Result, Reduced):
    """A number of a column of the history."""

    kind: Literal["history"]
    column: str = Field(description="of history.csv")

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """The column must be there."""
        check_history(scenario, self.column, refuse)

    def unit(self, scenario: Scenario) -> str:
        """That of the column."""
        return history_unit(self.column, scenario.dim)

    def read(self, run: Run) -> float:
        """What is taken of the column."""
        return self.reduced(history_series(run, self.column))


class OfGauge(Result, Reduced):
    """A number of a column of a gauge.

    Where it has several rows for a time each counts, for the least, the largest or the mean.
    """

    kind: Literal["gauge"]
    gauge: str = Field(description="[gauge.NAME] of the scenario")
    column: str = Field(description="of what the gauge reads")

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """The gauge and its column must be there."""
        check_gauge(scenario, self.gauge, self.column, refuse)
        if self.take not in REDUCTIONS:
            check_one_row(scenario, self.gauge, refuse)

    def unit(self, scenario: Scenario) -> str:
        """That of the column."""
        return scenario.gauge[self.gauge].columns(scenario.dim)[self.column]

    def read(self, run: Run) -> float:
        """What is taken of the column."""
        return self.reduced(gauge_series(run, self.gauge, self.column))


class OfFront(Result, Reduced):
    """A number of the position of the front along x, as snapshots have it."""

    kind: Literal["front"]

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """There must be a fluid."""
        check_fluid(scenario, refuse)

    def unit(self, scenario: Scenario) -> str:
        """Of a length."""
        return "m"

    def read(self, run: Run) -> float:
        """What is taken of the positions."""
        return self.reduced(front_series(run))


class FrontTime(Result):
    """When the front comes to a place; nan if it never does."""

    kind: Literal["front_time"]
    x: float = Field(description="m")

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """There must be a fluid."""
        check_fluid(scenario, refuse)

    def unit(self, scenario: Scenario) -> str:
        """Of a time."""
        return "s"

    def read(self, run: Run) -> float:
        """The time, linear between snapshots."""
        return time_of_front(run, self.x)


class RunOut(Result):
    """How far a flow on a map went, as the summary of the run tells."""

    kind: Literal["run_out"]
    value: Literal["distance", "angle", "area", "deposit_area", "deposit_volume"] = Field(
        "distance", description="which of these"
    )

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """There must be maps; distance and angle need a terrain."""
        check_maps(scenario, refuse)
        if self.value in ("distance", "angle") and scenario.terrain is None:
            raise refuse("value", f"{self.value} needs a [terrain]; area does not")

    def unit(self, scenario: Scenario) -> str:
        """That of the quantity."""
        return RUN_OUT[self.value]

    def read(self, run: Run) -> float:
        """The quantity; the distance of a flow that has got no farther than its start is 0 m.

        It is nan where nothing has flowed, and so is the angle of such a flow.
        """
        runout = run.summary.get("runout") or {}
        found = runout.get(self.value)
        if found is None and self.value == "distance" and runout.get("top") is not None:
            return 0.0
        return float("nan") if found is None else float(found)


class OfMap(Result):
    """A number of a map."""

    kind: Literal["map"]
    map: MapName = Field(description="a raster that the run keeps")
    take: Literal["max", "mean", "at"] = Field(
        "max", description="of all cells, of those that a flow reached, or of the cell of a place"
    )
    position: list[float] | None = Field(
        None, min_length=2, max_length=2, description='x, y, m; with take = "at"'
    )

    def objection(self) -> tuple[str, str] | None:
        """A place goes with take = "at"."""
        if (self.take == "at") == (self.position is None):
            return "position", 'goes with take = "at", which needs one'
        return None

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """There must be maps, and the place must lie on them."""
        check_maps(scenario, refuse)
        if self.position is None:
            return
        cells = _cells(scenario, refuse)
        if not cells.cells_at(*self.position)[2]:
            edges = ", ".join(f"{edge:.10g}" for edge in cells.extent)
            raise refuse(
                "position",
                f"= {self.position} lies off the map, [west, south, east, north] = [{edges}] m",
            )

    def unit(self, scenario: Scenario) -> str:
        """That of the map."""
        return MAPS[self.map].unit

    def read(self, run: Run) -> float:
        """The number; nan where the map has no data there."""
        raster = map_of(run, self.map)
        if self.position is not None:
            row, column, there = raster.cells_at(*self.position)
            return float(raster.values[row, column]) if there else float("nan")
        counts = covered(raster, self.map) if self.take == "mean" else np.isfinite(raster.values)
        values = raster.values[counts]
        if not len(values):
            return float("nan")
        return float(values.max() if self.take == "max" else values.mean())


class OfLoad(Result):
    """A number of the load on a structure."""

    kind: Literal["load"]
    gauge: str = Field(description="of kind load")
    value: Literal["step_peak", "mean_10ms", "mean_100ms", "impulse"] = Field(
        "mean_10ms", description="largest of a step, or of a running mean; or the impulse"
    )

    def check(self, scenario: Scenario, refuse: Refuse) -> None:
        """The gauge must be one of loads."""
        check_gauge(scenario, self.gauge, None, refuse)
        if not isinstance(scenario.gauge[self.gauge], Load):
            kind = getattr(scenario.gauge[self.gauge], "kind", "another")
            raise refuse("gauge", f"gauge {self.gauge} is of kind {kind}, not load")

    def unit(self, scenario: Scenario) -> str:
        """Of a force, or an impulse."""
        force = "N" if scenario.dim == 3 else "N/m"
        return force.replace("N", "N s") if self.value == "impulse" else force

    def read(self, run: Run) -> float:
        """The number; nan where samples are too far apart for a running mean."""
        found = next((load for load in body_loads(run) if load.name == self.gauge), None)
        if found is None:
            return float("nan")
        if self.value == "step_peak":
            return found.step_peak.value
        total = found.parts["total"]
        if self.value == "impulse":
            return total.impulse
        return total.means[WINDOWS[0] if self.value == "mean_10ms" else WINDOWS[1]].value


def covered(raster: Raster, name: MapName, above: float = 0.0) -> np.ndarray:
    """Mask (rows, cols) of where a map is greater than `above`.

    An arrival time may be 0: it counts from `above` on, where a flow came at all.
    """
    if name == ARRIVAL_TIME.name:
        return np.asarray(reached({name: raster}) & (raster.values >= above))
    return np.asarray(np.nan_to_num(raster.values) > above)


def _cells(scenario: Scenario, refuse: Refuse) -> Raster:
    """The cells of the maps of a scenario."""
    assert scenario.maps is not None
    settings = MapSettings.of(scenario.maps.model_dump(exclude_none=True), scenario.dp)
    try:
        return cells_of(None if scenario.bed is None else scenario.bed.raster, settings)
    except GeodataError as error:
        raise refuse("map", str(error)) from None


def map_of(run: Run, name: str) -> Raster:
    """A map that a run has kept; raises UserError where it has not."""
    maps = read_maps(run.folder)
    if name not in maps:
        raise UserError(f"{run.directory}: the run has kept no maps")
    return maps[name]


RESULTS: dict[str, type[Result]] = {
    "history": OfHistory, "gauge": OfGauge, "front": OfFront, "front_time": FrontTime,
    "run_out": RunOut, "map": OfMap, "load": OfLoad,
}  # fmt: skip
