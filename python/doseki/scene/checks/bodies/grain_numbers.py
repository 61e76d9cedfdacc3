"""Checks of gauges that follow grains by their numbers."""

from __future__ import annotations

from ....scenario.gauges.motion import Motion
from ....scenario.model import Scenario
from ...bodies import Bodies

MAX_ROWS = 1e7  # of a gauge


def check_grain_numbers(scenario: Scenario, bodies: Bodies) -> None:
    """Raise UserError for gauges of grains that there are not, or of too many too often."""
    count = {group.name: len(group) for group in bodies.groups}
    for name, gauge in scenario.gauge.items():
        if not isinstance(gauge, Motion):
            continue
        there = sum(count[body] for body in gauge.bodies)
        highest = max(gauge.grains or [0])
        if highest >= there:
            raise scenario.where.error(
                ("gauge", name, "grains"),
                f"gauge.{name}.grains: there is no grain {highest}; "
                f"{', '.join(gauge.bodies)} has {there}, from 0 to {there - 1}",
            )
        followed = len(gauge.grains) if gauge.grains else there
        rows = followed * scenario.time_max / scenario.interval_of(gauge)
        if rows > MAX_ROWS:
            raise scenario.where.error(
                ("gauge", name, "interval"),
                f"gauge.{name}: {followed} grains every {scenario.interval_of(gauge):g} s are "
                f"{rows:.1e} rows, at most {MAX_ROWS:g} are written; name some of them in grains",
            )
