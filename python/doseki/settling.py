"""Grains that settle dry under gravity before a run starts: bodies alone, in the compiled core."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from .grains import Group, turn
from .lattice import rotated
from .particles import BOUND
from .periodic import periods, wrapped
from .rigid_bodies import Bodies, add_bodies
from .scenario import Scenario
from .solid_shapes import box_shape

# At rest: the fastest grain goes at this part of sqrt(g d) or slower.
REST = 1e-3
# Falls from the top of everything to its bottom after which a packing is taken as it is.
PATIENCE = 10.0
FOREVER = 10**9  # steps

Make = Callable[[Scenario, list[str]], Any]  # a simulation of nothing but its materials


def settled(scenario: Scenario, groups: list[Group], names: list[str], make: Make) -> list[Group]:
    """The groups, with the grains of each [body.NAME] that settles where they come to rest.

    One body after the other in the order of the scenario, held by the sides of its box: those
    before it stand still, those after it are not there yet.  Raises UserError where grains fall
    out of the scene.
    """
    waits = {g.name: bool(getattr(scenario.body.get(g.name), "settle", False)) for g in groups}
    there = [replace(g, fixed=True) for g in groups if not waits[g.name]]
    found: dict[str, Group] = {}
    for group in sorted((g for g in groups if waits[g.name]), key=_order(scenario)):
        found[group.name] = _at_rest(scenario, group, there, names, make)
        there.append(replace(found[group.name], fixed=True))
    return [found.get(group.name, group) for group in groups]


def _order(scenario: Scenario) -> Callable[[Group], int]:
    names = list(scenario.body)
    return lambda group: names.index(group.name)


def _at_rest(
    scenario: Scenario, group: Group, there: list[Group], names: list[str], make: Make
) -> Group:
    gravity = float(np.linalg.norm(scenario.gravity))
    if gravity == 0:
        raise _error(scenario, group, "there is no gravity")
    simulation = make(scenario, names)
    _fill(simulation, scenario, [group, *there, *_sides(scenario, group)], names)
    simulation.start()
    low, high = _extent(scenario, [group, *there])
    diameter = 2 * min(shape.reach for shape in group.shapes)
    pause, slow = np.sqrt(diameter / gravity), REST * np.sqrt(gravity * diameter)
    settle = scenario.body[group.name].settle
    end = PATIENCE * np.sqrt(2 * (high - low) / gravity) if settle is True else settle
    fastest = np.inf
    while simulation.time < end and (fastest > slow or settle is not True):
        until = min(simulation.time + pause, end)
        simulation.advance(limit=until, pause=until, max_steps=FOREVER)
        bodies, mine = simulation.grains(), slice(len(group))
        centre, orientation = bodies["centre"][mine], bodies["orientation"][mine]
        group = replace(group, centre=centre, orientation=orientation)
        fastest = float(np.linalg.norm(bodies["velocity"][mine], axis=1).max())
        if _height(scenario, group.centre).min() < 2 * low - high:
            raise _error(
                scenario, group, "grains fall out of the scene: put a body under all of their box"
            )
    if settle is True and fastest > slow:
        scenario.warnings.append(
            f"{group.name}: after {end:.3g} s of settling the fastest grain still has "
            f"{fastest:.2g} m/s; all start at rest from where they are"
        )
    return replace(group, centre=wrapped(scenario, group.centre))


def _error(scenario: Scenario, group: Group, why: str) -> Exception:
    keys = ("body", group.name, "settle")
    return scenario.where.error(keys, f"body.{group.name}.settle: {why}")


def _fill(simulation: Any, scenario: Scenario, groups: list[Group], names: list[str]) -> None:
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


def _sides(scenario: Scenario, group: Group) -> Iterator[Group]:
    """Walls along the sides of the box, from well below to well above it.

    Periodic axes that the box spans have none.
    """
    body, dim = scenario.body[group.name], scenario.dim
    size, thick = body.max - body.min, 2 * max(shape.reach for shape in group.shapes)
    pivot = body.min if body.pivot is None else body.pivot
    for axis in range(dim - 1):
        if _spans(scenario, body, axis):
            continue
        extent = size + 2 * thick
        extent[-1], extent[axis] = 3 * size[-1], thick
        for edge, outwards in ((body.min, -0.5), (body.max, 0.5)):
            centre = 0.5 * (body.min + body.max)
            centre[axis] = edge[axis] + outwards * thick
            centre = rotated(centre[None, :], body.rotate, pivot, body.rotate_axis)
            yield Group(
                group.name,
                [box_shape(extent)],
                np.zeros(1, np.int32),
                centre,
                turn(scenario, body)[None, :],
                group.material,
                fixed=True,
            )


def _spans(scenario: Scenario, body: Any, axis: int) -> bool:
    period = periods(scenario)[axis]
    return bool(not body.rotate and period and body.max[axis] - body.min[axis] > 0.999 * period)


def _height(scenario: Scenario, position: np.ndarray) -> np.ndarray:
    """Against gravity, m."""
    up = -np.asarray(scenario.gravity, float)
    return position @ (up / np.linalg.norm(up))


def _extent(scenario: Scenario, groups: list[Group]) -> tuple[float, float]:
    """The lowest and the highest that bodies reach."""
    height = np.concatenate([_height(scenario, group.centre) for group in groups])
    reach = np.concatenate([np.array([s.reach for s in g.shapes])[g.shape] for g in groups])
    return float((height - reach).min()), float((height + reach).max())
