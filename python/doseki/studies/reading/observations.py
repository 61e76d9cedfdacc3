"""What runs are compared with: tables [observation.NAME], each of which gives a run a misfit.

A misfit is a difference in units of the error of the observation: 1 is as near as can be expected.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from ...errors import UserError
from ...geodata.crs import not_compared_text, why_not_compared
from ...geodata.errors import GeodataError
from ...geodata.features import Features, read_on_map
from ...record.reader import Run
from ...scenario.model import Scenario
from ...scenario.table import Table
from ...util.input_file import digest_of
from ...util.spelling import suggestion
from .kinds import Refuse, check_fluid, check_gauge, check_maps, check_one_row
from .observed_files import check_errors, read_series, read_table, read_words
from .results import MapName, Result, covered, map_of
from .series import ROUNDING, Series, front_series, gauge_series

Results = Mapping[str, Result]


class Observation(Table):
    """Something that was measured, and how much it counts."""

    weight: float = Field(1.0, gt=0, le=1e6, description="in the score, a weighted mean of squares")

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """Raise where it cannot be compared with runs of the scenario; returns what to warn of."""
        raise NotImplementedError

    def misfit(self, run: Run, results: Mapping[str, float], folder: Path) -> float:
        """Difference over error of a run with these `results`; nan where it has none.

        `folder` is that to which names of files are relative.
        """
        raise NotImplementedError

    def digest(self, folder: Path) -> str:
        """Of the content of its file; empty without one."""
        file = self.given("file")
        return "" if file is None else digest_of(folder / file)


class ObservedValue(Observation):
    """One number, as a level or the time of a front."""

    kind: Literal["value"]
    result: str = Field(description="[result.NAME] that it is compared with")
    value: float = Field(description="in the unit of the result")
    error: float = Field(gt=0, description="standard error, in the unit of the result")

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """The result must be there."""
        _check_result(self.result, results, refuse)
        return []

    def misfit(self, run: Run, results: Mapping[str, float], folder: Path) -> float:
        """Of the number."""
        return abs(results[self.result] - self.value) / self.error


class ObservedValues(Observation):
    """Numbers of a CSV file with columns result, value and perhaps error."""

    kind: Literal["values"]
    file: str = Field(description="CSV: result,value,error")
    error: float | None = Field(None, gt=0, description="standard error of all; or a column error")

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """Every result must be there, with an error."""
        table, names = self._read(folder)
        for name in names:
            _check_result(name, results, refuse)
        _check_error(self.error, table, refuse)
        return []

    def misfit(self, run: Run, results: Mapping[str, float], folder: Path) -> float:
        """Root of the mean square of all."""
        table, names = self._read(folder)
        found = np.array([results[name] for name in names])
        return _rms((found - table["value"]) / _error(self.error, table))

    def _read(self, folder: Path) -> tuple[dict[str, np.ndarray], list[str]]:
        path = folder / self.file
        # Each row has the unit of its own result.
        table = read_table(path, {"value": ""}, {"error": ""})
        check_errors(path, table)
        return table, read_words(path, "result")


class OverTime(Observation):
    """A series over time, from a CSV file."""

    file: str = Field(description="CSV with a column time, one of values, and perhaps error")
    error: float | None = Field(None, gt=0, description="standard error of all; or a column error")

    def series(self, run: Run) -> Series:
        """The same series of a run."""
        raise NotImplementedError

    def column_and_unit(self, scenario: Scenario) -> tuple[str, str]:
        """The column of the file, and the unit of its numbers."""
        raise NotImplementedError

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """There must be an error, and times that runs have."""
        path = folder / self.file
        table = read_series(path, *self.column_and_unit(scenario))
        check_errors(path, table)
        _check_error(self.error, table, refuse)
        time = table["time"]
        outside = (time < scenario.begins_at) | (time > scenario.time_max)
        if outside.all():
            raise refuse(
                "file",
                f"{path}: all of its times, {time[0]:g} to {time[-1]:g} s, are outside of the runs,"
                f" {scenario.begins_at:g} to {scenario.time_max:g} s",
            )
        if outside.any():
            return [f"{path}: {outside.sum()} of {len(time)} times are outside of the runs"]
        return []

    def misfit(self, run: Run, results: Mapping[str, float], folder: Path) -> float:
        """Root of the mean square over the times that both have; nan where the run has a gap."""
        series = self.series(run)
        # The unit of the run's own record, for which the study was checked.
        column = getattr(self, "column", "x")
        table = read_series(folder / self.file, column, series.unit)
        first, last = series.time[[0, -1]] if len(series.time) else (np.inf, -np.inf)
        common = (table["time"] >= first) & (table["time"] <= last)
        found = series.at(table["time"][common])
        return _rms((found - table["value"][common]) / _error(self.error, table, common))


class ObservedSeries(OverTime):
    """What a gauge should have read."""

    kind: Literal["series"]
    gauge: str = Field(description="[gauge.NAME] of the scenario")
    column: str = Field(description="of what the gauge reads, and of the file")

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """The gauge must be there, with one row for each time."""
        check_gauge(scenario, self.gauge, self.column, refuse)
        check_one_row(scenario, self.gauge, refuse)
        said = super().check(scenario, results, folder, refuse)
        self._check_begun(scenario, folder, refuse)
        return said

    def _check_begun(self, scenario: Scenario, folder: Path, refuse: Refuse) -> None:
        """A column of means since the sample before has none at the first."""
        gauge = scenario.gauge[self.gauge]
        if self.column not in gauge.since_before(scenario.dim):
            return
        path = folder / self.file
        time = read_series(path, *self.column_and_unit(scenario))["time"]
        first = scenario.begins_at + scenario.interval_of(gauge)
        early = time[(time >= scenario.begins_at) & (time < first * (1 - ROUNDING))]
        if len(early):
            raise refuse(
                "file",
                f"{path}: time = {early[0]:g} s is before {first:g} s, when gauge {self.gauge} has "
                f"its first {self.column}, of the time since the sample before; leave it out",
            )

    def column_and_unit(self, scenario: Scenario) -> tuple[str, str]:
        """Those of the gauge."""
        return self.column, scenario.gauge[self.gauge].columns(scenario.dim)[self.column]

    def series(self, run: Run) -> Series:
        """What it read."""
        return gauge_series(run, self.gauge, self.column)


class ObservedFront(OverTime):
    """Where the front was along x: columns time and x."""

    kind: Literal["front"]

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """There must be a fluid."""
        check_fluid(scenario, refuse)
        return super().check(scenario, results, folder, refuse)

    def column_and_unit(self, scenario: Scenario) -> tuple[str, str]:
        """A position, m."""
        return "x", "m"

    def series(self, run: Run) -> Series:
        """Of the snapshots."""
        return front_series(run)


class ObservedArea(Observation):
    """Polygons of what was covered: one less the area that both cover over that which either does.

    Jaccard's distance, 0 where the outlines are the same and 1 where they have nothing in common.
    """

    kind: Literal["area"]
    file: str = Field(description="polygons: .geojson, .shp or .gpkg")
    map: MapName = Field("peak_depth", description="of the run")
    above: float = Field(0.0, ge=0, description="value of the map from which a cell is covered")
    error: float = Field(1.0, gt=0, description="that counts as one: share of the area")

    def check(
        self, scenario: Scenario, results: Results, folder: Path, refuse: Refuse
    ) -> list[str]:
        """There must be maps, and polygons in their coordinate reference system."""
        check_maps(scenario, refuse)
        raster = scenario.bed.raster if scenario.bed is not None else None
        crs = raster.crs if raster is not None else None
        found = self._features(folder, crs)
        why = why_not_compared(found.crs, crs) if raster is not None else None
        return [not_compared_text(folder / self.file, why)] if why else []

    def misfit(self, run: Run, results: Mapping[str, float], folder: Path) -> float:
        """Jaccard's distance over the error; raises UserError for polygons beside the map."""
        raster = map_of(run, self.map)
        mapped = covered(raster, self.map, self.above)
        x, y = np.meshgrid(raster.x, raster.y)
        seen = np.zeros(raster.shape, bool)
        seen |= self._features(folder, raster.crs).contains(x, y)
        if not seen.any():
            raise UserError(f"{folder / self.file}: its polygons lie beside the map of the run")
        either = np.count_nonzero(mapped | seen)
        return (1 - np.count_nonzero(mapped & seen) / either) / self.error

    def _features(self, folder: Path, crs: str | None) -> Features:
        """With its polygons, on the map of `crs`."""
        path = folder / self.file
        try:
            found = read_on_map(path, crs)
        except GeodataError as error:
            raise UserError(str(error)) from None
        if not found.polygons:
            raise UserError(f"{path}: holds lines alone; an area needs polygons, which are closed")
        return found


def total_score(observations: Mapping[str, Observation], misfits: Mapping[str, float]) -> float:
    """Root of the weighted mean of squared misfits; nan where one is missing, or there is none."""
    if not observations:
        return float("nan")
    weights = np.array([each.weight for each in observations.values()])
    squares = np.array([misfits[name] for name in observations]) ** 2
    return float(np.sqrt(np.sum(weights * squares) / weights.sum()))


def _check_result(name: str, results: Results, refuse: Refuse) -> None:
    if name not in results:
        near = suggestion(name, results) or "; the study has no [result]"
        raise refuse("result", f'no result is called "{name}"{near}')


def _check_error(given: float | None, table: Mapping[str, np.ndarray], refuse: Refuse) -> None:
    """An error stands in the file or in the table, not in both."""
    if ("error" in table) == (given is not None):
        which = "in neither" if given is None else "in both"
        raise refuse("error", f"must stand in the file, as a column, or here; it is {which}")


def _error(
    given: float | None, table: Mapping[str, np.ndarray], rows: np.ndarray | None = None
) -> np.ndarray | float:
    if given is not None:
        return given
    return table["error"] if rows is None else table["error"][rows]


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


OBSERVATIONS: dict[str, type[Observation]] = {
    "value": ObservedValue, "values": ObservedValues, "series": ObservedSeries,
    "front": ObservedFront, "area": ObservedArea,
}  # fmt: skip
