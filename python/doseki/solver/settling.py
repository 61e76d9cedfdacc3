"""Grains that settle dry under gravity before a run starts: bodies alone, in the compiled core."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..compiled import load_core
from ..errors import PhysicsError
from ..record.particles import BOUND
from ..scenario.checks.effort import contact_steps
from ..scenario.kinematics import FIXED
from ..scenario.model import Scenario
from ..scene.bodies import Bodies
from ..scene.build import Settled
from ..scene.groups import Group
from ..scene.kinds.body import Body
from ..scene.kinds.registry import body_of
from ..scene.periodic import wrapped
from ..util.finding import Finding
from .protocol import CoreSimulation
from .rigid_bodies import add_bodies

# At rest: the fastest grain goes at this part of sqrt(g d) or slower.
REST = 1e-3
# Falls from the top of everything to its bottom after which a packing is taken as it is.
PATIENCE = 10.0
FOREVER = 10**9  # steps
MOST_STEPS = 3e8  # of contacts, in which a packing may come to rest
CALM_STEPS = 12  # in a contact, at most

Make = Callable[[Scenario, list[str]], CoreSimulation]  # a simulation of nothing but its materials


@dataclass(frozen=True)
class StillMoving(Finding):
    """Grains that have not come to rest in the time that settling may take."""

    time: float  # s, spent settling
    speed: float  # m/s, of the fastest grain

    def __str__(self) -> str:
        return (
            f"{self.place}: after {self.time:.3g} s of settling the fastest grain still has "
            f"{self.speed:.2g} m/s; all start at rest from where they are"
        )


def settled(scenario: Scenario, groups: list[Group], names: list[str], make: Make) -> Settled:
    """The groups, with the grains of each [body.NAME] that settles where they come to rest.

    One body after the other in the order of the scenario, held by the sides of its box: those
    before it stand still, those after it are not there yet.  Raises UserError where grains fall
    out of the scene.
    """
    waits = {name for name, body in scenario.body.items() if body.given("settle")}
    waits -= scenario.carried
    there = [replace(g, kinematics=FIXED) for g in groups if g.name not in waits]
    found: dict[str, Group] = {}
    warnings: list[Finding] = []
    for group in sorted((g for g in groups if g.name in waits), key=_order(scenario)):
        found[group.name], unrest = _at_rest(scenario, group, there, names, make)
        warnings += unrest
        there.append(replace(found[group.name], kinematics=FIXED))
    return Settled([found.get(group.name, group) for group in groups], warnings)


def _order(scenario: Scenario) -> Callable[[Group], int]:
    names = list(scenario.body)
    return lambda group: names.index(group.name)


def _at_rest(
    scenario: Scenario, group: Group, there: list[Group], names: list[str], make: Make
) -> tuple[Group, list[Finding]]:
    """The group at rest, and a warning where it was still moving when patience ended."""
    body = body_of(scenario, group.name)
    gravity = float(np.linalg.norm(scenario.gravity))
    if gravity == 0:
        raise body.error(".settle: there is no gravity", "settle")
    simulation = make(scenario, names)
    thickness = 2 * max(shape.reach for shape in group.shapes)
    _fill(simulation, scenario, [group, *there, *body.sides(thickness)], names)
    simulation.start()
    low, high = _extent(scenario, [group, *there])
    diameter = 2 * min(shape.reach for shape in group.shapes)
    pause, slow = np.sqrt(diameter / gravity), REST * np.sqrt(gravity * diameter)
    settle = body.table.given("settle")
    end = PATIENCE * np.sqrt(2 * (high - low) / gravity) if settle is True else settle
    _check_effort(scenario, body, diameter, end)
    fastest = np.inf
    while simulation.time < end and (fastest > slow or settle is not True):
        until = min(simulation.time + pause, end)
        try:
            simulation.advance(limit=until, pause=until, max_steps=FOREVER)
        except load_core().PhysicsFailure as failure:
            raise PhysicsError(f"body.{group.name}: settling fails: {failure}") from None
        bodies, mine = simulation.grains(), slice(len(group))
        centre, orientation = bodies["centre"][mine], bodies["orientation"][mine]
        group = replace(group, centre=centre, orientation=orientation)
        fastest = float(np.linalg.norm(bodies["velocity"][mine], axis=1).max())
        if _height(scenario, group.centre).min() < 2 * low - high:
            raise body.error(
                ".settle: grains fall out of the scene: put a body under all of their box", "settle"
            )
    warnings: list[Finding] = []
    if settle is True and fastest > slow:
        warnings.append(StillMoving(group.name, end, fastest))
    return replace(group, centre=wrapped(scenario, group.centre)), warnings


def _check_effort(scenario: Scenario, body: Body[Any], diameter: float, end: float) -> None:
    """Refuse to settle what would go on for days without coming to rest."""
    share = min(1.0, CALM_STEPS / scenario.contact.steps)
    steps = share * contact_steps(scenario, diameter, end)
    if not steps <= MOST_STEPS:
        raise body.error(
            f".settle: {end:.3g} s of settling would take {steps:.2g} steps, more than "
            f"{MOST_STEPS:g}: give settle in s, a larger contact.overlap, or a lower contact.speed",
            "settle",
        )


def _fill(
    simulation: CoreSimulation, scenario: Scenario, groups: list[Group], names: list[str]
) -> None:
    """Bodies at rest, and the one particle without which nothing runs: in the first of them."""
    first, n, dim = groups[0], sum(len(group) for group in groups), scenario.dim
    rho0 = scenario.materials[first.material].rho0
    simulation.add_particles(
        position=first.centre[:1],
        velocity=np.zeros((1, dim)),
        mass=np.array([rho0 * scenario.dp**dim]),
        density=np.array([rho0]),
        smoothing_length=np.array([scenario.eta * scenario.dp]),
        material=np.array([scenario.material_names.index(first.material)], np.int32),
        body=np.array([names.index(first.name)], np.int32),
        motion=np.array([BOUND], np.int32),
        id=np.zeros(1, np.int64),
    )
    none = np.zeros((1, dim))
    simulation.set_walls(normal=none, depth=np.array([first.shapes[first.shape[0]].reach]))
    still = Bodies(
        groups, np.zeros((n, dim)), np.zeros((n, 3)), np.zeros(1, np.int32), none, none, none
    )
    add_bodies(simulation, scenario, still, names)


def _height(scenario: Scenario, position: np.ndarray) -> np.ndarray:
    """Against gravity, m."""
    up = -np.asarray(scenario.gravity, float)
    return position @ (up / np.linalg.norm(up))


def _extent(scenario: Scenario, groups: list[Group]) -> tuple[float, float]:
    """The lowest and the highest that bodies reach."""
    height = np.concatenate([_height(scenario, group.centre) for group in groups])
    reach = np.concatenate([np.array([s.reach for s in g.shapes])[g.shape] for g in groups])
    return float((height - reach).min()), float((height + reach).max())
