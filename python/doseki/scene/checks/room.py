"""What is left of bodies whose particles make room for others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...record.particles import FREE, ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.bodies import Box
from ...scenario.tables.terrain.release import Release
from ...scenario.tables.terrain.terrain import TERRAIN
from ...util.finding import Finding
from ..ground import LEAST_HEIGHT, ground_of
from ..groups import Group, inside_bodies

MOST = 0.5  # share of a body that fixed ones may take without a word
NOTABLE = 0.05  # the same of one whose volume is told: a release, a lake on a terrain


@dataclass(frozen=True)
class Displaced(Finding):
    """A body of which fixed ones take much."""

    share: float  # that is gone
    taker: str

    def __str__(self) -> str:
        return (
            f"{self.place}: {100 * self.share:.0f} % of it lies inside fixed bodies, most of that "
            f"inside body.{self.taker}, and is left out: move one of the two if that is not meant"
        )


def room_findings(
    scenario: Scenario,
    before: Mapping[str, ParticleSet],
    after: Mapping[str, ParticleSet],
    takers: Mapping[str, Sequence[Group]],
) -> Iterator[Finding]:
    """A doubt about each body of which others take much, `after` they have taken room.

    Much is more than half; of a body whose volume is told, NOTABLE of what the ground leaves of it.
    What bodies that move take is meant: water in the pores of grains.  `takers` are those that each
    makes room for.  Raises UserError where nothing is left of a body.
    """
    for name, particles in before.items():
        there, left = _free(particles), _free(after[name])
        most = NOTABLE if _is_told(scenario, name) else MOST
        if len(left) > (1 - most) * len(there) or not len(there):
            continue
        if not len(left):
            taker, _ = _taken(scenario, there, takers[name])
            _refuse(scenario, name, taker or TERRAIN)
        if most < MOST:
            there = _above_ground(scenario, there)
        taker, share = _taken(scenario, there, [group for group in takers[name] if group.fixed])
        if share > most:
            yield Displaced(_place(scenario, name), share, taker)


def _is_told(scenario: Scenario, name: str) -> bool:
    """Whether `check` and the summary tell the volume of a body."""
    if scenario.bed is None or name in scenario.carried:
        return False
    return isinstance(scenario.body.get(name), Release | Box)


def _above_ground(scenario: Scenario, position: np.ndarray) -> np.ndarray:
    assert scenario.bed is not None
    height = ground_of(scenario.bed).height_above(position)
    return position[height > LEAST_HEIGHT * scenario.dp]


def _taken(scenario: Scenario, position: np.ndarray, groups: Sequence[Group]) -> tuple[str, float]:
    """The name of those that hold most of these places, "" for none, and the share of all."""
    held = np.zeros(len(position), bool)
    counts = {"": 0}
    for group in groups:
        inside = inside_bodies(scenario, [group], position)
        counts[group.name] = counts.get(group.name, 0) + int(inside.sum())
        held |= inside
    return max(counts, key=counts.__getitem__), float(held.mean())


def _free(particles: ParticleSet) -> np.ndarray:
    """Positions (n, dim) of those that move, m."""
    return particles.position[particles.motion == FREE]


def _place(scenario: Scenario, name: str) -> str:
    return f"body.{name}" if name in scenario.body else f"inflow.{name}"


def _refuse(scenario: Scenario, name: str, taker: str) -> None:
    place = _place(scenario, name)
    where = "in the ground of the terrain" if taker == TERRAIN else f"inside body.{taker}"
    raise scenario.where.error(
        tuple(place.split(".", 1)),
        f"{place}: nothing of it is left, since it lies {where}; move one of the two, make "
        f"{place} larger, or remove it",
    )
