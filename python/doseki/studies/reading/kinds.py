"""Kinds of tables of a study, each with its keys and what it does, told apart by `kind`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ...errors import UserError
from ...record.history import history_columns
from ...scenario.gauges.gauge import Gauge
from ...scenario.gauges.motion import Motion
from ...scenario.kinematics import RIGID
from ...scenario.model import Scenario
from ...scenario.table import Table
from ...scenario.tables.bodies import Grains
from ...util.spelling import suggestion

# Turns a key and what is wrong with it into the error that names file and line.
Refuse = Callable[[str, str], UserError]
KindTables = Mapping[str, type[Table]]


def check_gauge(scenario: Scenario, gauge: str, column: str | None, refuse: Refuse) -> None:
    """Raise where the scenario has no such gauge, or the gauge no such column."""
    if gauge not in scenario.gauge:
        raise refuse(
            "gauge", f'the scenario has no gauge "{gauge}"{suggestion(gauge, scenario.gauge)}'
        )
    known = scenario.gauge[gauge].columns(scenario.dim)
    if column is not None and column not in known:
        raise refuse("column", f'gauge {gauge} has no column "{column}"{suggestion(column, known)}')


def check_one_row(scenario: Scenario, gauge: str, refuse: Refuse) -> None:
    """Raise where a gauge has several rows for a time, which make no series."""
    found = scenario.gauge[gauge]
    if not (found.has_one_row or _is_of_one_grain(scenario, found)):
        raise refuse("gauge", f"a gauge of kind {found.kind} has several rows for each time")


def _is_of_one_grain(scenario: Scenario, gauge: Gauge) -> bool:
    """Whether a gauge follows the motion of one body, which has a row for each time."""
    if not isinstance(gauge, Motion):
        return False
    if gauge.grains is not None:
        return len(gauge.grains) == 1
    if len(gauge.bodies) != 1:
        return False
    name = gauge.bodies[0]
    table = scenario.body[name]
    is_one = scenario.kinematics_of(name) is RIGID or table.given("fill") == "single"
    return is_one and not isinstance(table, Grains)


def check_history(scenario: Scenario, column: str, refuse: Refuse) -> None:
    """Raise where the history of a run has no such column."""
    known = history_columns(scenario.dim, scenario.material_names)
    if column not in known:
        raise refuse("column", f'no column "{column}" in the history{suggestion(column, known)}')


def check_maps(scenario: Scenario, refuse: Refuse) -> None:
    """Raise where runs keep no maps."""
    if scenario.maps is None:
        raise refuse("kind", "the scenario keeps no maps: give it a table [maps]")


def check_fluid(scenario: Scenario, refuse: Refuse) -> None:
    """Raise where nothing flows, so that there is no front."""
    if scenario.is_dry:
        raise refuse("kind", "nothing in the scenario is a fluid, so there is no front")


def objection_of(table: Table) -> tuple[str, str] | None:
    """What a table says of keys of its own that do not go together."""
    objects: Callable[[], Any] | None = getattr(table, "objection", None)
    return objects() if objects is not None else None
