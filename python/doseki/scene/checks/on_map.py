"""What starts beyond the map of a terrain, or where it has no data, and would leave at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...record.particles import FREE, ParticleSet
from ...scenario.model import Scenario
from ...util.finding import Finding, percent
from ..ground import ground_of
from ..groups import Group
from ..kinds.body import Body

WHERE = "beyond the terrain, or where it has no data"


@dataclass(frozen=True)
class RolledOff(Finding):
    """Grains that settled beyond the map."""

    count: int
    all: int
    at: list[float]  # m

    def __str__(self) -> str:
        return (
            f"{self.place}: {self.count:,} of its {self.all:,} bodies settled {WHERE}, as at "
            f"{self.at} m, and leave at once: put something in their way, or take a larger map"
        )


def check_particles_on_map(
    scenario: Scenario, bodies: Mapping[str, Body[Any]], loose: Mapping[str, ParticleSet]
) -> None:
    """Raise UserError for particles that are free and lie where the map says nothing."""
    if scenario.bed is None:
        return
    for name, particles in loose.items():
        if name in bodies and name not in scenario.carried:
            places = particles.position[particles.motion == FREE]
            _refuse(bodies[name], places, "particles", _is_off(scenario, places))


def check_bodies_on_map(
    scenario: Scenario, bodies: Mapping[str, Body[Any]], groups: Sequence[Group]
) -> None:
    """Raise UserError for bodies that have their centres there, unless they are held in place."""
    if scenario.bed is None:
        return
    for group in groups:
        if _may_leave(scenario, bodies, group):
            off = _is_off(scenario, group.centre)
            _refuse(bodies[group.name], group.centre, "bodies", off)


def rolled_off(scenario: Scenario, groups: Sequence[Group], waits: set[str]) -> Iterator[Finding]:
    """A doubt about each of the groups that settled, of names `waits`, partly beyond the map."""
    if scenario.bed is None:
        return
    for group in groups:
        off = _is_off(scenario, group.centre)
        if group.name in waits and off.any():
            at = _told(group.centre, off)
            yield RolledOff(f"body.{group.name}", int(off.sum()), len(group), at)


def _may_leave(scenario: Scenario, bodies: Mapping[str, Body[Any]], group: Group) -> bool:
    if group.fixed or group.name not in bodies or group.name in scenario.carried:
        return False
    return not bodies[group.name].is_clamped


def _is_off(scenario: Scenario, places: np.ndarray) -> np.ndarray:
    """Mask (N,) of places (N, dim) of which the map says nothing."""
    assert scenario.bed is not None
    plan = np.ascontiguousarray(places[:, :-1])
    return np.asarray(ground_of(scenario.bed).field.at(plan)["unknown"], bool)


def _told(places: np.ndarray, off: np.ndarray) -> list[float]:
    """The first of these places in plan, m."""
    found: list[float] = np.round(places[np.argmax(off), :-1], 3).tolist()
    return found


def _refuse(body: Body[Any], places: np.ndarray, what: str, off: np.ndarray) -> None:
    """Raise UserError where any of the places of a body, which are those of `what`, is off."""
    if not off.any():
        return
    part = f"{off.sum():,} of its {len(off):,} {what} ({percent(float(off.mean()))}) "
    part += "lies" if off.sum() == 1 else "lie"
    said = "lies" if len(off) == 1 else f"all of its {what} lie" if off.all() else part
    raise body.error(
        f": {said} {WHERE}, as at {_told(places, off)} m, and would leave at once: move it or make "
        "it smaller, take a larger map, or fill its cells without data"
    )
