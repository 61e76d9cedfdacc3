"""What would begin, or be due again, after a run has ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...scenario.model import Scenario
from ...scenario.tables.inflow import Inflow
from ...util.finding import Finding

ROUNDING = 1e-9


@dataclass(frozen=True)
class TooLate(Finding):
    """A time that the run does not get to."""

    time: float  # s
    time_max: float  # s

    def __str__(self) -> str:
        return (
            f"{self.place}: not before {self.time:g} s, and the run ends at time_max = "
            f"{self.time_max:g} s"
        )


@dataclass(frozen=True)
class LongInterval(Finding):
    """An interval between outputs that is longer than the run."""

    interval: float  # s
    length: float  # s, of the run

    def __str__(self) -> str:
        return (
            f"{self.place} = {self.interval:g} s is longer than the run, {self.length:g} s: it is "
            "due at the start and at the end alone"
        )


def late_findings(scenario: Scenario) -> Iterator[Finding]:
    """One for each motion, inflow, figure and interval that this run sees nothing of.

    It may be continued.
    """
    for place, time in _beginnings(scenario):
        if time >= scenario.time_max:
            yield TooLate(place, time, scenario.time_max)
    for name, figure in scenario.figure.items():
        times: list[float] = figure.given("times") or []
        if times and max(times) > scenario.time_max * (1 + ROUNDING):
            yield TooLate(f"figure.{name}.times", max(times), scenario.time_max)
    length = scenario.time_max - scenario.begins_at
    for place, interval in _intervals(scenario):
        if interval > length * (1 + ROUNDING):
            yield LongInterval(place, interval, length)


def _intervals(scenario: Scenario) -> Iterator[tuple[str, float]]:
    """Of snapshots and history, and those that gauges and maps have of their own."""
    yield "time_out", scenario.time_out
    yield "time_history", scenario.time_history
    for name, gauge in scenario.gauge.items():
        if gauge.interval is not None:
            yield f"gauge.{name}.interval", gauge.interval
    if scenario.maps is not None and scenario.maps.interval is not None:
        yield "maps.interval", scenario.maps.interval


def _beginnings(scenario: Scenario) -> Iterator[tuple[str, float]]:
    for name, body in scenario.body.items():
        motion = body.prescribed_motion
        if motion is None:
            continue
        if motion.velocity is not None or motion.angular_velocity is not None:
            yield f"body.{name}.motion.start", motion.start
        if motion.removed_at is not None:
            yield f"body.{name}.motion.removed_at", motion.removed_at
    for name, inflow in scenario.inflow.items():
        yield f"inflow.{name}", _begins(inflow)


def _begins(inflow: Inflow) -> float:
    """When the first of it enters, s: within the first stretch in which no factor stays at 0."""
    rows = inflow.rows if inflow.surge is None else np.array(inflow.surge, dtype=float)
    enters = (rows[1:, 1:] + rows[:-1, 1:] > 0).all(axis=1)
    return float(inflow.rows[int(enters.argmax()), 0])
