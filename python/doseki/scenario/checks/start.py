"""Checks of a scenario against the run that it starts from."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

from ..earlier import Earlier
from ..model import Scenario
from ..tables.body import BodyTable
from ..tables.wall import FRICTION_OF

# What the state of a run was made with, or means something else without.
SAME_OF_RUN = (
    "dim", "scheme", "dp", "precision", "kernel", "eos", "eta", "h_mode", "xi", "periodic",
    "domain_min", "domain_max",
)  # fmt: skip
# Density and pressure follow from one another by these.
SAME_OF_MATERIAL = ("law", "rho0", "speedsound", "gamma")
# Of a body that is there already: how fluid meets it, what it does from now on, how it resists.
# A file is known by its digest.
MAY_CHANGE = {"wall", *FRICTION_OF, "motion", "elastic_law", "damping", "hourglass", "file"}


def check_start(scenario: Scenario) -> None:
    """Raise UserError where a scenario cannot go on from the state of the earlier run."""
    earlier = scenario.earlier
    if earlier is None:
        return
    own = tomllib.loads(scenario.effective_toml())
    _check_run(scenario, earlier, own)
    if not earlier.time < scenario.time_max:
        raise scenario.where.error(
            ("time_max",),
            f"time_max = {scenario.time_max:g} s has passed: the run starts at {earlier.time:g} s; "
            "time_max must be later",
        )
    _check_names(scenario, earlier)
    for name in sorted(scenario.carried):
        _check_table(scenario, earlier, own, name)
    for name, inflow in scenario.inflow.items():
        then = earlier.section("inflow").get(name, {}).get("material", inflow.material)
        if then != inflow.material:
            raise scenario.where.error(
                ("inflow", name, "material"),
                f"inflow.{name}.material = {inflow.material} cannot change: its {then} is there",
            )
    for name in _materials_of(scenario, earlier):
        _check_material(scenario, earlier, own, name)


def _check_run(scenario: Scenario, earlier: Earlier, own: Mapping[str, Any]) -> None:
    for key in SAME_OF_RUN:
        if key in earlier.scenario and own.get(key) != earlier.scenario[key]:
            now, then = own.get(key), earlier.scenario[key]
            raise scenario.where.error(
                (scenario.sound_speed_key[0] if key == "xi" else key,),
                f"{key} = {now} cannot change: the run that this one starts from has {then}",
            )


def _check_names(scenario: Scenario, earlier: Earlier) -> None:
    """All that is there must be named: as it was, or as what is left out."""
    assert scenario.start is not None
    there = {name: section for section in ("inflow", "body") for name in earlier.section(section)}
    for name in scenario.start.without:
        if name not in there:
            raise scenario.where.error(
                ("start", "without"),
                f'start.without: the earlier run has no "{name}"; it has {", ".join(there)}',
            )
        if name in scenario.body or name in scenario.inflow:
            raise scenario.where.error(
                ("start", "without"),
                f'start.without: "{name}" is left out, but [{there[name]}.{name}] is there',
            )
    for name, section in there.items():
        present = name in getattr(scenario, section) or name in scenario.start.without
        if not present:
            raise scenario.where.error(
                ("start",),
                f"[{section}.{name}] of the earlier run is missing: keep the table, or leave it "
                f'out by start.without = ["{name}"]',
            )


def _check_table(scenario: Scenario, earlier: Earlier, own: Mapping[str, Any], name: str) -> None:
    """What made a body cannot change any more: it is there."""
    then, now = earlier.section("body")[name], own["body"][name]
    if not isinstance(then, dict):
        then = {}
    for key in sorted((set(then) | set(now)) - MAY_CHANGE):
        default = _default(scenario.body[name], key)
        if then.get(key, default) != now.get(key, default):
            raise scenario.where.error(
                ("body", name, key),
                f"body.{name}.{key} cannot change: the body comes from the earlier run, which has "
                f"{then.get(key, 'no such key')}; a body of another name is added",
            )


def _default(table: BodyTable, key: str) -> Any:
    field = type(table).model_fields.get(key)
    return None if field is None or field.is_required() else field.get_default()


def _materials_of(scenario: Scenario, earlier: Earlier) -> list[str]:
    """The materials of what carries over."""
    there = set(earlier.snapshot.material_names)
    return [name for name in scenario.material_names if name in there]


def _check_material(
    scenario: Scenario, earlier: Earlier, own: Mapping[str, Any], name: str
) -> None:
    then, now = earlier.section("material").get(name), own["material"].get(name)
    if not isinstance(then, dict) or not isinstance(now, dict):
        return
    for key in SAME_OF_MATERIAL:
        if then.get(key) != now.get(key):
            raise scenario.where.error(
                ("material", name, key),
                f"material.{name}.{key} = {now.get(key)} cannot change: the run that this one "
                f"starts from has {then.get(key)}",
            )
