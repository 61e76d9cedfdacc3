"""Keys of materials that have no effect where a deformable body touches another one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..record.particles import BOUND, FIXED
from ..scenario.kinematics import BREAKABLE, DEFORM
from ..scenario.model import Scenario
from ..util.finding import Finding
from .estimates import State, wave_speed

MISSING = {"rolling_friction": 0.0, "restitution": 1.0}  # what such contacts have instead


@dataclass(frozen=True)
class WithoutEffect(Finding):
    """A key of a material that contacts with a deformable body do not have."""

    value: float
    body: str  # that deforms
    speed: float | None  # m/s, from which on it does; nan: not known, None: always

    def __str__(self) -> str:
        when = ""
        if self.speed is not None:
            known = "" if math.isnan(self.speed) else f" {self.speed:.2g} m/s,"
            when = f" while it deforms (struck faster than{known} Eq. 139a)"
        return (
            f"{self.place} = {self.value:g} has no effect where bodies touch {self.body}{when}: "
            f"what they lose there, body.{self.body}.damping takes"
        )


@dataclass(frozen=True)
class _Bodies:
    """The bodies of one name [body.NAME]."""

    name: str
    material: str
    count: int  # of those that move as a whole
    deforms: bool


def keys_without_effect(
    scenario: Scenario, state: State, names: dict[int, str]
) -> Iterator[WithoutEffect]:
    """Those that the file gives to a material of a body that deforms, or may touch one.

    Of others, materials are left out whose bodies can touch more rigid ones that move: there the
    key acts.  So are breakable bodies that nothing strikes fast enough.
    """
    bodies = list(_bodies(scenario, state, names))
    soft = [b for b in bodies if b.deforms and _may_deform(scenario, b)]
    rigid = sum(b.count for b in bodies if not b.deforms)
    told = {body.material: body for body in reversed(soft)}
    for body in bodies:
        if soft and body.material not in told:
            others = rigid - (1 if body.count else 0)
            if not body.deforms and sum(b.count for b in soft) >= others:
                told[body.material] = soft[0]
    for key, missing in MISSING.items():
        places = {_given_in(scenario, name, key): body for name, body in reversed(told.items())}
        for place, body in sorted((p, b) for p, b in places.items() if p is not None):
            value = getattr(scenario.materials[place], key)
            if value != missing:
                speed = _waking_speed(scenario, body)
                yield WithoutEffect(f"material.{place}.{key}", value, body.name, speed)


def _bodies(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[_Bodies]:
    for index, name in names.items():
        of_it = (state["body"] == index) & np.isin(state["motion"], (BOUND, FIXED))
        if name not in scenario.body or not of_it.any():
            continue
        kind = scenario.kinematics_of(name).name
        moves = of_it & (state["motion"] == BOUND)
        count = len(np.unique(state["grain"][moves])) if moves.any() and "grain" in state else 0
        material = scenario.material_names[state["material"][of_it][0]]
        yield _Bodies(name, material, count, kind in DEFORM)


def _may_deform(scenario: Scenario, body: _Bodies) -> bool:
    speed = _waking_speed(scenario, body)
    contact = scenario.contact.speed or 0.1 * scenario.xi * scenario.min_sound_speed
    return speed is None or not speed > contact


def _waking_speed(scenario: Scenario, body: _Bodies) -> float | None:
    """From which on a breakable body deforms that strikes what is rigid, m/s (Eq. 139a)."""
    if scenario.kinematics_of(body.name).name != BREAKABLE.name:
        return None
    material = scenario.materials[body.material]
    if material.fracture != "cohesive":  # random flaws decide
        return math.nan
    return material.of_laws["tensile_strength"] / (material.rho0 * wave_speed(material))


def _given_in(scenario: Scenario, name: str | None, key: str) -> str | None:
    """The table [material.NAME] from which a material has a key; None where no table gives it."""
    while name in scenario.material:
        table = scenario.material[name]
        if table.given(key) is not None:
            return name
        name = table.given("based_on")
    return None
