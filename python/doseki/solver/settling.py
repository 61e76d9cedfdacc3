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
from ..scene.build import Settled, settling
from ..scene.checks.groups import check_overlaps
from ..scene.groups import Group
from ..scene.kinds.body import Body
from ..scene.kinds.registry import body_of
from ..scene.periodic import wrapped
from ..scene.shapes import no_edges
from ..util.finding import Finding
from ..util.telling import Tell, say_nothing
from .protocol import CoreSimulation
from .rigid_bodies import add_bodies

# At rest: the fastest grain goes at this part of sqrt(g d) or slower.
REST = 1e-3
# Falls from the top of everything to its bottom after which a packing is taken as it is, and after
# which it is where it has come no nearer to rest.
PATIENCE, IDLE = 10.0, 2.0
NEARER = 0.9  # of the kinetic energy before: what counts as nearer to rest
STEPS = 2000  # between two looks at how far it is
MOST_STEPS = 3e8  # of contacts, in which a packing may come to rest
CALM_STEPS = 12  # in a contact, at most

Make = Callable[[Scenario, list[str]], CoreSimulation]  # a simulation of nothing but its materials


@dataclass(frozen=True)
class StillMoving(Finding):
    """Grains that have not come to rest in the time that settling may take."""

    time: float  # s, spent settling
    speed: float  # m/s, of the fastest grain
    idle: float  # s, at the end, in which nothing came nearer to rest

    def __str__(self) -> str:
        if self.idle:
            return (
                f"{self.place}: settling is ended after {self.time:.3g} s, of which the last "
                f"{self.idle:.3g} s brought no grain nearer to rest: the fastest has "
                f"{self.speed:.2g} m/s (what rolls for ever needs rolling_friction); all start at "
                "rest from where they are"
            )
        return (
            f"{self.place}: after {self.time:.3g} s of settling the fastest grain still has "
            f"{self.speed:.2g} m/s; all start at rest from where they are"
        )


class Watch:
    """How long nothing has come nearer to rest: neither lower than ever, nor slower since then."""

    def __init__(self, diameter: float) -> None:
        """Of grains whose least `diameter`, m, says what counts as lower."""
        self.time = self.last = 0.0
        self._lower = REST * diameter
        self._calmest = self._lowest = np.inf

    def see(self, time: float, speed: np.ndarray, height: np.ndarray) -> None:
        """Take note of the speeds, m/s, and heights, m, of the grains at a time, s."""
        self.time = time
        energy, level = float((speed**2).mean()), float(height.mean())
        is_lower = level < self._lowest - self._lower
        if is_lower:
            self._lowest = level
        if is_lower or energy < NEARER * self._calmest:
            self._calmest, self.last = energy, time

    @property
    def idle(self) -> float:
        """Since then, s."""
        return self.time - self.last


def settled(
    scenario: Scenario, groups: list[Group], names: list[str], make: Make, tell: Tell = say_nothing
) -> Settled:
    """The groups, with the grains of each [body.NAME] that settles where they come to rest.

    One body after the other in the order of the scenario, held by the sides of its box: those
    before it stand still, those after it are not there yet.  Raises UserError where grains fall
    out of the scene, or start within those that have settled.
    """
    waits = settling(scenario)
    there = [replace(g, kinematics=FIXED) for g in groups if g.name not in waits]
    found: dict[str, Group] = {}
    warnings: list[Finding] = []
    for group in sorted((g for g in groups if g.name in waits), key=_order(scenario)):
        check_overlaps(scenario, [group, *there])
        found[group.name], unrest = _at_rest(scenario, group, there, names, make, tell)
        warnings += unrest
        there.append(replace(found[group.name], kinematics=FIXED))
    return Settled([found.get(group.name, group) for group in groups], warnings)


def _order(scenario: Scenario) -> Callable[[Group], int]:
    names = list(scenario.body)
    return lambda group: names.index(group.name)


def _at_rest(
    scenario: Scenario, group: Group, there: list[Group], names: list[str], make: Make, tell: Tell
) -> tuple[Group, list[Finding]]:
    """The group at rest, and a warning where it was still moving when patience ended."""
    body = body_of(scenario, group.name)
    if not np.any(scenario.gravity):
        raise body.error(".settle: there is no gravity", "settle")
    low, high = _extent(scenario, [group, *there])
    scales = _Scales.of(scenario, group, high - low)
    settle = body.table.given("settle")
    end = PATIENCE * scales.fall if settle is True else settle
    _check_effort(scenario, body, scales.diameter, end)
    simulation = make(scenario, names)
    thickness = 2 * max(shape.reach for shape in group.shapes)
    _fill(simulation, scenario, [group, *there, *body.sides(thickness)], names)
    simulation.start()
    fastest, watch = np.inf, Watch(scales.diameter)
    while simulation.time < end and (fastest > scales.slow or settle is not True):
        _advance(simulation, min(simulation.time + scales.pause, end), group.name, end, tell)
        bodies, mine = simulation.grains(), slice(len(group))
        centre, orientation = bodies["centre"][mine], bodies["orientation"][mine]
        group = replace(group, centre=wrapped(scenario, centre), orientation=orientation)
        # Wrapped: where a periodic axis slopes, what slides along it for ever comes no lower.
        height = _height(scenario, group.centre)
        speed = np.linalg.norm(bodies["velocity"][mine], axis=1)
        fastest = float(speed.max())
        if height.min() < 2 * low - high:
            why = ".settle: grains fall out of the scene: put a body under all of their box"
            raise body.error(why, "settle")
        watch.see(simulation.time, speed, height)
        if settle is True and watch.idle > IDLE * scales.fall:
            break
    if settle is not True or fastest <= scales.slow:
        return group, []
    idle = watch.idle if watch.idle > IDLE * scales.fall else 0.0
    return group, [StillMoving(group.name, simulation.time, fastest, idle)]


@dataclass(frozen=True)
class _Scales:
    """What settling is measured by."""

    diameter: float  # m, of the smallest grain
    pause: float  # s, in which it falls by half of that
    fall: float  # s, from the top of everything to its bottom
    slow: float  # m/s, at rest

    @classmethod
    def of(cls, scenario: Scenario, group: Group, height: float) -> _Scales:
        """For grains in a scene of some height, m."""
        gravity = float(np.linalg.norm(scenario.gravity))
        diameter = 2 * min(shape.reach for shape in group.shapes)
        pause, fall = np.sqrt(diameter / gravity), np.sqrt(2 * height / gravity)
        return cls(diameter, float(pause), float(fall), REST * np.sqrt(gravity * diameter))


def _advance(simulation: CoreSimulation, until: float, name: str, end: float, tell: Tell) -> None:
    """Step to a time, s, saying now and then how far it is; raises PhysicsError where it fails."""
    try:
        while simulation.time < until:
            simulation.advance(limit=until, pause=until, max_steps=STEPS)
            tell(f"body.{name} settles: {simulation.time:.3g} s of at most {end:.3g} s")
    except load_core().PhysicsFailure as failure:
        raise PhysicsError(f"body.{name}: settling fails: {failure}") from None


def _check_effort(scenario: Scenario, body: Body[Any], diameter: float, end: float) -> None:
    """Refuse to settle what would go on for days without coming to rest."""
    share = min(1.0, CALM_STEPS / scenario.steps_of_contact)
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
    reach = np.array([first.shapes[first.shape[0]].reach])
    simulation.set_walls(normal=none, depth=reach, curvature=np.zeros(1))
    surface = none, none, none, none, *no_edges(1, dim)
    still = Bodies(groups, np.zeros((n, dim)), np.zeros((n, 3)), np.zeros(1, np.int32), *surface)
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
