"""Series of a run over time, and what one number is made of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field

from ...errors import UserError
from ...measure import numbers as measure
from ...measure.series import first_above
from ...measure.views import fluid_names, select, way_of_flow, whole_space
from ...record.reader import Run
from ...scenario.table import Table

REDUCTIONS: dict[str, Callable[[np.ndarray], float]] = {
    "min": np.min,
    "max": np.max,
    "mean": np.mean,
}
ROUNDING = 1e-9  # of a time, within which it is that of a sample
Taken = Literal["last", "first", "min", "max", "mean", "at"]


class Reduced(Table):
    """What one number is made of a series: keys that all kinds of series have."""

    take: Taken = Field("last", description="what one number is made of the series")
    at: float | None = Field(None, description='s; with take = "at", linear between samples')
    after: float | None = Field(None, description="s; samples before do not count")
    before: float | None = Field(None, description="s; samples after do not count")

    def objection(self) -> tuple[str, str] | None:
        """A key that does not go with the others, and why; None where all do."""
        if self.take == "at" and self.at is None:
            return "at", 'is missing: take = "at" needs a time, s'
        if self.take != "at" and self.at is not None:
            return "at", 'goes with take = "at"'
        for key in ("after", "before"):
            if self.take == "at" and getattr(self, key) is not None:
                return key, 'does not go with take = "at"'
        if self.after is not None and self.before is not None and self.after >= self.before:
            return "after", "must be less than before"
        return None

    def reduced(self, series: Series) -> float:
        """One number of a series; nan where it has no sample that counts."""
        time, value = series.time, series.value
        if self.take == "at":
            assert self.at is not None
            return series.at(np.array([self.at]))[0]
        first = -np.inf if self.after is None else self.after
        last = np.inf if self.before is None else self.before
        chosen = value[(time >= first) & (time <= last) & np.isfinite(value)]
        if not len(chosen):
            return float("nan")
        if self.take in ("first", "last"):
            return float(chosen[0 if self.take == "first" else -1])
        return float(REDUCTIONS[self.take](chosen))


@dataclass(frozen=True)
class Series:
    """Values (n,) in `unit` at times (n,), s, that do not fall."""

    time: np.ndarray
    value: np.ndarray
    unit: str

    def at(self, times: np.ndarray) -> np.ndarray:
        """Values at times (m,), s, linear between samples; nan outside, and beside a gap."""
        if not len(self.time):
            return np.full(len(times), np.nan)
        after = np.minimum(np.searchsorted(self.time, times), len(self.time) - 1)
        before = np.maximum(after - 1, 0)
        near = np.where(times - self.time[before] < self.time[after] - times, before, after)
        known = np.isclose(times, self.time[near], rtol=ROUNDING, atol=0.0)
        between = np.interp(times, self.time, self.value, left=np.nan, right=np.nan)
        return np.where(known, self.value[near], between)


def gauge_series(run: Run, gauge: str, column: str) -> Series:
    """A column of a gauge; raises UserError where the run has not recorded it."""
    record = run.gauges.get(gauge)
    if record is None or column not in record.columns or "time" not in record.columns:
        raise UserError(f"{run.directory}: gauge {gauge} has not recorded {column}")
    return Series(record["time"], record[column], record.units[column])


def history_series(run: Run, column: str) -> Series:
    """A column of the history."""
    if column not in run.history.columns:
        raise UserError(f"{run.directory}: the history has no column {column}")
    return Series(run.history["time"], run.history[column], run.history.units[column])


def front_series(run: Run) -> Series:
    """Where the foremost fluid is along x, m, in each snapshot; nan where there is none."""
    return _front_along(run, way_of_flow(run) or 1)


def _front_along(run: Run, direction: int) -> Series:
    """The same of a flow along +x or -x: `direction` is 1 or -1."""
    fluids, everywhere = fluid_names(run), whole_space(run.scenario["dim"])
    front = []
    for snapshot in run:
        there = select(snapshot, everywhere, fluids)
        front.append(measure.front(snapshot["position"][there, 0], direction))
    return Series(run.times, np.array(front, dtype=float), "m")


def time_of_front(run: Run, x: float) -> float:
    """When the front comes to x, s, linear between snapshots; nan if it never does."""
    direction = way_of_flow(run) or 1
    series = _front_along(run, direction)
    known = np.isfinite(series.value)
    if not known.any():
        return float("nan")
    return first_above(series.time[known], direction * series.value[known], direction * x)
