"""Checks of gauges and figures against the rest of a scenario."""

from __future__ import annotations

from ...record.history import history_columns
from ..gauges.gauge import Gauge
from ..gauges.loads.approach import Approach
from ..gauges.loads.load import Load
from ..model import Scenario
from ..tables.figure import Drawable

MAX_SAMPLES = 1e6
MACH = 0.1  # of the fastest flow that a sound speed is meant for


def check_gauges(scenario: Scenario) -> None:
    """Raise UserError for gauges that can show nothing."""
    setting = scenario.setting()
    for name, gauge in scenario.gauge.items():
        _check_interval(scenario, name, gauge)
        for key, why in gauge.objections(setting):
            raise scenario.where.error(("gauge", name, key), f"gauge.{name}.{key}{why}")
        if isinstance(gauge, Load) and gauge.approach is not None:
            _check_approach(scenario, name, gauge.approach)


def _check_approach(scenario: Scenario, name: str, approach: str) -> None:
    found = scenario.gauge[approach]
    if not isinstance(found, Approach):
        raise scenario.where.error(
            ("gauge", name, "approach"),
            f'gauge.{name}.approach = "{approach}" is a gauge of kind "{found.kind}", '
            'not "approach"',
        )


def check_figures(scenario: Scenario) -> None:
    """Raise UserError for figures of what is not there: none must fail after a long run."""
    around = Drawable(
        dim=scenario.dim,
        gauges=scenario.gauge,
        history=history_columns(scenario.dim, scenario.material_names),
        speed=MACH * scenario.xi * scenario.min_sound_speed,
    )
    for name, figure in scenario.figure.items():
        for key, why in figure.objections(around):
            raise scenario.where.error(("figure", name, key), f"figure.{name}.{key}{why}")


def _check_interval(scenario: Scenario, name: str, gauge: Gauge) -> None:
    interval = scenario.interval_of(gauge)
    if scenario.time_max / interval > MAX_SAMPLES:
        raise scenario.where.error(
            ("gauge", name, "interval"),
            f"gauge.{name}.interval = {interval:g} s is too short for time_max = "
            f"{scenario.time_max:g} s; at most {MAX_SAMPLES:g} samples are taken",
        )
