"""What the gauges of a scenario measure: their columns and times, and checks of their tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .nearest import suggestion
from .schema import Discharge, FlowGauge, ForceGauge, Gauge, PressureGauge, SurfaceHeight
from .schemes import UETA2022

if TYPE_CHECKING:
    from .scenario import Scenario

MAX_SAMPLES = 1e6


def gauge_columns(gauge: Gauge, dim: int) -> dict[str, str]:
    """Name and unit of each column of a gauge's file."""
    axes = "xyz"[:dim]
    time = {"time": "s"}
    if isinstance(gauge, SurfaceHeight):
        return time | {"height": "m"}
    if isinstance(gauge, PressureGauge):
        return time | {"pressure": "Pa"}
    if isinstance(gauge, Discharge):
        units = ("m2/s", "kg/s/m") if dim == 2 else ("m3/s", "kg/s")
        return time | {"discharge": units[0], "mass_rate": units[1]}
    if isinstance(gauge, ForceGauge):
        force, moment = ("N/m", "N") if dim == 2 else ("N", "N m")
        moments = ["moment"] if dim == 2 else [f"moment_{axis}" for axis in axes]
        return time | {f"force_{axis}": force for axis in axes} | dict.fromkeys(moments, moment)
    velocities = {f"velocity_{axis}": "m/s" for axis in axes}
    return time | {"height": "m"} | velocities | {"fraction": "1"}


def gauge_interval(scenario: Scenario, gauge: Gauge) -> float:
    """Time between two samples, s."""
    return scenario.time_out if gauge.interval is None else gauge.interval


def check_gauges(scenario: Scenario) -> None:
    """Raise UserError for gauges that can show nothing, and for figures of what is not there."""
    for name, gauge in scenario.gauge.items():
        _check_interval(scenario, name, gauge)
        direction = getattr(gauge, "direction", None)
        if direction is not None and not np.any(direction):
            keys = ("gauge", name, "direction")
            message = f"gauge.{name}.direction must not be the zero vector"
            raise scenario.where.error(keys, message)
        if isinstance(gauge, FlowGauge):
            _check_inside(scenario, name, gauge)
        if isinstance(gauge, ForceGauge):
            _check_force(scenario, name, gauge)
    _check_figures(scenario)


def _check_interval(scenario: Scenario, name: str, gauge: Gauge) -> None:
    interval = gauge_interval(scenario, gauge)
    if scenario.time_max / interval > MAX_SAMPLES:
        raise scenario.where.error(
            ("gauge", name, "interval"),
            f"gauge.{name}.interval = {interval:g} s is too short for time_max = "
            f"{scenario.time_max:g} s; at most {MAX_SAMPLES:g} samples are taken",
        )


def _check_inside(scenario: Scenario, name: str, gauge: FlowGauge) -> None:
    low, high = scenario.domain_min, scenario.domain_max
    if low is None or high is None or not np.all(low < high):
        return
    if np.any(gauge.position < low) or np.any(gauge.position > high):
        raise scenario.where.error(
            ("gauge", name, "position"),
            f"gauge.{name}.position = {gauge.position.tolist()} lies outside the domain, "
            f"{low.tolist()} to {high.tolist()} m",
        )


def _check_force(scenario: Scenario, name: str, gauge: ForceGauge) -> None:
    keys, where = ("gauge", name, "bodies"), scenario.where
    for body in gauge.bodies:
        if body not in scenario.body:
            known = suggestion(body, scenario.body)
            message = f'gauge.{name}.bodies: "{body}" is not a known body{known}'
            raise where.error(keys, message)
        if not scenario.body[body].fixed:
            raise where.error(keys, f'gauge.{name}.bodies: "{body}" is not a fixed body')
    if scenario.scheme == UETA2022:
        raise where.error(
            ("gauge", name, "kind"),
            f'gauge.{name}.kind = "force" needs scheme = "resolved"; {scenario.scheme} has no force'
            " on walls",
        )


def _check_figures(scenario: Scenario) -> None:
    """A figure must not fail at the end of a long run."""
    for name, figure in scenario.figure.items():
        if figure.kind != "gauge":
            continue
        if figure.gauge is None:
            message = f"figure.{name}.gauge is missing (name of a [gauge.NAME])"
            raise scenario.where.error(("figure", name), message)
        known = gauge_columns(scenario.gauge[figure.gauge], scenario.dim)
        for column in figure.columns:
            if column not in known:
                keys = ("figure", name, "columns")
                message = f'figure.{name}.columns: "{column}" is not a column of {figure.gauge}'
                raise scenario.where.error(keys, message + suggestion(column, known))
