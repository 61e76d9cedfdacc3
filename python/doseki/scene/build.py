"""The scene of a run: particles and bodies, made from a scenario."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..record.particles import BOUND, FIXED, FREE, ParticleSet, check_size, concatenate
from ..scenario.model import Scenario
from ..scenario.schemes import RESOLVED
from ..scenario.tables.bodies import Polygon, Polyhedron
from ..scenario.tables.terrain.terrain import TERRAIN
from ..util.finding import Finding
from .bodies import Bodies, ElasticBody
from .carried import (
    CarriedOver,
    carried_over,
    placed_groups,
    placed_parts,
    present,
)
from .checks.bodies.clamping import clamp_findings, clamped_points
from .checks.bodies.gaps import gap_findings
from .checks.fracture import fracture_warnings
from .checks.groups import check_overlaps, period_findings
from .checks.on_map import check_bodies_on_map, check_particles_on_map, rolled_off
from .checks.outflows import far_findings, outflow_findings
from .checks.particle_overlaps import find_overlaps
from .checks.particles import check_particles
from .checks.placing import placing_findings
from .checks.resolution import resolution_warnings
from .checks.room import room_findings
from .checks.terrain import terrain_findings
from .checks.times import late_findings
from .contacts import contact_groups
from .ground import LEAST_HEIGHT, ground_of
from .groups import Group, inside_bodies, particles_of
from .kinds.body import Body
from .kinds.registry import bodies_of
from .meshes.meeting import without_common
from .moved import Displacement
from .shapes import no_edges
from .unions.thinning import ways_into_rows

BURIED = 0.5  # spacings in the ground that no flow gets to


class Settled(NamedTuple):
    """Groups of bodies where they come to rest, and what did not."""

    groups: list[Group]
    warnings: list[Finding]


Settle = Callable[[Scenario, list[Group], list[str]], Settled]


@dataclass(frozen=True)
class Scene:
    """What a run starts from: particles, the names of their bodies, and rigid bodies."""

    particles: ParticleSet
    names: list[str]
    bodies: Bodies
    warnings: list[Finding]  # what is allowed but probably not meant
    stress: np.ndarray | None = None  # (N, 3, 3) deviatoric, Pa; None: none


def build_bodies(scenario: Scenario) -> tuple[ParticleSet, list[str]]:
    """The particles of all bodies, and the names their `body` indices stand for.

    The names of the inflows come last; no particle has them yet.  Raises UserError, or
    ResourceError when there are too many particles.  Grains stand as they were packed.
    """
    scene = build_scene(scenario)
    return scene.particles, scene.names


def settling(scenario: Scenario) -> set[str]:
    """Names of the bodies that settle before the start, one after the other."""
    return {n for n, body in scenario.body.items() if body.given("settle")} - scenario.carried


def build_scene(scenario: Scenario, settle: Settle | None = None) -> Scene:
    """The particles and rigid bodies of a scenario, with warnings; see `build_bodies`.

    `settle` moves bodies to where they come to rest: from all of them, those that stay last, and
    the names of bodies to all of them.
    """
    bodies, warnings = present(scenario, bodies_of(scenario)), list[Finding]()
    check_size({f"body.{name}": body.count() for name, body in bodies.items()})
    warnings += scenario.findings
    warnings += [finding for body in bodies.values() for finding in body.findings()]
    names = body_names(scenario)
    carried = carried_over(scenario, names)
    built = _loose_particles(scenario, bodies, names)
    ways = _ways_into_rows(scenario, bodies, built)
    _move_fixed(built, ways)
    parts = placed_parts(scenario, carried, built, ways)
    made = [body.group() for body in bodies.values() if body.is_of_bodies]
    made = placed_groups(scenario, carried, made)
    check_bodies_on_map(scenario, bodies, made)
    groups = sorted(made, key=lambda group: group.fixed)
    moves = any(not group.fixed for group in groups)
    loose = concatenate(list(parts.values()), scenario.dim)
    walls = list(contact_groups(scenario, bodies, names, loose))
    if moves:
        groups += walls
        warnings += resolution_warnings(bodies, groups)
        warnings += fracture_warnings(bodies, made)
        warnings += period_findings(scenario, groups)
        warnings += gap_findings(scenario, groups, loose.position[loose.motion == FREE])
        check_overlaps(scenario, groups, settling(scenario))
        if settle is not None:
            groups, unsettled = settle(scenario, groups, names)
            warnings += [*unsettled, *rolled_off(scenario, groups, settling(scenario))]
    solids = groups if moves else [*groups, *walls]
    whole = {group.name for group in made}
    whole |= {n for n, body in bodies.items() if body.contact_shape() is not None}
    takers = {name: _takers(scenario, name, solids, whole) for name in parts}
    wished = parts
    parts = {name: _outside(scenario, part, takers[name]) for name, part in parts.items()}
    if scenario.bed is not None:
        parts = {n: _above_ground(scenario, n, part) for n, part in parts.items()}
    warnings += room_findings(scenario, wished, parts, takers)
    check_particles_on_map(scenario, bodies, parts)
    particles, rigid, origin = _joined(scenario, bodies, names, parts, groups, carried)
    _put_in_rows(scenario, particles, names, {n: way for n, way in ways.items() if n not in parts})
    check_particles(scenario, particles, names)
    warnings += list(terrain_findings(scenario, bodies))
    warnings += list(placing_findings(scenario, particles, names))
    warnings += [*outflow_findings(scenario, particles, names, groups), *late_findings(scenario)]
    warnings += far_findings(scenario, particles, names)
    clamped = clamped_points(rigid.elastic, len(particles))
    warnings += find_overlaps(particles, names, scenario.carried, clamped)
    warnings += clamp_findings(bodies, rigid.elastic)
    if carried is None:
        return Scene(particles, names, rigid, warnings)
    warnings += carried.findings(moves)
    return Scene(particles, names, rigid, warnings, carried.stresses(origin))


def particles_at_zero(scenario: Scenario, names: list[str]) -> dict[str, ParticleSet]:
    """The particles of each body as its table has it, before anything has moved or settled."""
    bodies = bodies_of(scenario)
    loose, made = _loose_particles(scenario, bodies, names), {}
    for name, body in bodies.items():
        if body.is_of_bodies:
            group = body.group()
            placed, owner = particles_of(group, body.spacing, scenario.dim)
            made[name] = body.particles_of_bodies(group, names, placed, owner)
        else:
            made[name] = loose[name]
    _move_fixed(made, _ways_into_rows(scenario, bodies, loose))
    return made


def _move_fixed(parts: Mapping[str, ParticleSet], ways: Mapping[str, np.ndarray]) -> None:
    """Moves the fixed particles of some bodies by so much, at time zero."""
    for name in ways.keys() & parts.keys():
        parts[name].position[parts[name].motion == FIXED] += ways[name]


def _ways_into_rows(
    scenario: Scenario, bodies: Mapping[str, Body[Any]], loose: Mapping[str, ParticleSet]
) -> dict[str, np.ndarray]:
    """By how much (n, dim) particles of fixed bodies go, from where their tables have them."""
    if not any(_may_thin(body) for body in bodies.values()):
        return {}
    walls = {name: part.position[part.motion == FIXED] for name, part in loose.items()}
    for name, body in bodies.items():
        if name not in walls and body.table.fixed and body.plane_faces() is not None:
            walls[name] = particles_of(body.group(), body.spacing, scenario.dim)[0].position
    return ways_into_rows(
        scenario, bodies, {name: wall for name, wall in walls.items() if len(wall)}
    )


def _may_thin(body: Body[Any]) -> bool:
    """Whether it has sides that slant to each other, and is a wall."""
    kinds = isinstance(body.table, Polygon | Polyhedron)
    return body.scenario.scheme == RESOLVED and body.table.fixed and kinds


def _put_in_rows(
    scenario: Scenario, particles: ParticleSet, names: list[str], ways: Mapping[str, np.ndarray]
) -> None:
    """Moves the particles of fixed bodies by so much, turned as the bodies have since."""
    for name, way in ways.items():
        turned = Displacement(scenario, name).vectors(way)
        particles.position[particles.body == names.index(name)] += turned


def _loose_particles(
    scenario: Scenario, bodies: Mapping[str, Body[Any]], names: list[str]
) -> dict[str, ParticleSet]:
    """The particles of each body whose particles are no parts of bodies."""
    loose = {name: body for name, body in bodies.items() if not body.is_of_bodies}
    built = {name: body.particles(names) for name, body in loose.items()}
    return without_common(scenario, built, {name: body.spacing for name, body in loose.items()})


def _joined(
    scenario: Scenario,
    bodies: Mapping[str, Body[Any]],
    names: list[str],
    parts: Mapping[str, ParticleSet],
    groups: list[Group],
    carried: CarriedOver | None,
) -> tuple[ParticleSet, Bodies, np.ndarray]:
    """The parts in the order of the scenario, what inflows have brought last.

    Also the row of each particle in the snapshot that it comes from, or -1.
    """
    sets: list[ParticleSet] = []
    tables: list[_PointTable] = []
    moves = any(not group.fixed for group in groups)
    kept = [group for group in groups if not group.elastic] if moves else []
    first = dict(zip((g.name for g in kept), _first_indices(kept), strict=True))
    elastic: list[ElasticBody] = []
    of_name = {group.name: group for group in reversed(groups)}
    for name in dict.fromkeys([*bodies, *parts]):
        if name in parts:
            sets.append(parts[name])
            tables.append(_PointTable.of_loose(sets[-1]))
            continue
        if name not in of_name:  # all of its bodies have left
            continue
        body, group = bodies[name], of_name[name]
        placed, owner = particles_of(group, body.spacing, scenario.dim)
        points = body.particles_of_bodies(group, names, placed, owner)
        if group.deforms:
            made = body.elastic_bodies(group, placed, owner, sum(map(len, sets)))
            if carried is not None and name in scenario.carried:
                points, made = carried.elastic(name, points, made)
            elastic += made
        sets.append(points)
        still = group.fixed or group.elastic
        grain = np.full(len(owner), -1) if still else first[name] + owner
        shaped = np.ones(len(owner), bool)
        surface = placed.normal, placed.depth, placed.curvature, *placed.edges
        tables.append(_PointTable(grain.astype(np.int32), shaped, *surface))
    particles = concatenate(sets, scenario.dim)
    table = _PointTable.joined(tables, scenario.dim)
    velocity, spin = _velocities(scenario, bodies, kept, carried)
    return particles, Bodies(kept, velocity, spin, *table, elastic), _origins(scenario, sets, names)


def _origins(scenario: Scenario, sets: list[ParticleSet], names: list[str]) -> np.ndarray:
    """The `id` of particles that carry over, else -1."""
    bodies = {each for name in scenario.carried for each in scenario.names_of_bodies(name)}
    found = [names.index(each) for each in (*bodies, *scenario.inflow)]
    rows = [
        np.where(np.isin(part.body, found) & (part.motion != BOUND), part.id, -1) for part in sets
    ]
    return np.concatenate([np.zeros(0, np.int64), *rows])


class _PointTable(NamedTuple):
    """What Bodies says of each of N particles."""

    grain: np.ndarray
    shaped: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    curvature: np.ndarray
    edge_normals: np.ndarray
    edge_depths: np.ndarray

    @classmethod
    def of_loose(cls, particles: ParticleSet) -> _PointTable:
        """Of particles that are no parts of bodies."""
        n, dim = len(particles), particles.dim
        none = np.full(n, -1, np.int32)
        plane = np.zeros(n)
        edges = no_edges(n, dim)
        return cls(none, np.zeros(n, bool), np.zeros((n, dim)), plane, plane, *edges)

    @classmethod
    def joined(cls, tables: Iterable[_PointTable], dim: int) -> _PointTable:
        """The tables one after the other."""
        empty = cls.of_loose(ParticleSet.empty(dim))
        return cls(*(np.concatenate(column) for column in zip(empty, *tables, strict=True)))


def _first_indices(groups: list[Group]) -> list[int]:
    """The index of the first body of each group."""
    ends = np.cumsum([0, *(len(group) for group in groups)])
    return [int(end) for end in ends[:-1]]


def _velocities(
    scenario: Scenario,
    bodies: Mapping[str, Body[Any]],
    groups: list[Group],
    carried: CarriedOver | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Velocities (n, dim) and spins (n, 3) of bodies at the start."""
    velocity, spin = [np.zeros((0, scenario.dim))], [np.zeros((0, 3))]
    for group in groups:
        if carried is not None and group.name in scenario.carried and not group.fixed:
            moving, turning = carried.velocities(group.name)
            velocity.append(moving)
            spin.append(turning)
            continue
        body = bodies.get(group.name)
        still = np.zeros_like(group.centre)
        velocity.append(body.velocity_at(group.centre) if body is not None else still)
        turning = body.spin if body is not None else np.zeros(3)
        spin.append(np.tile(turning, (len(group), 1)))
    return np.concatenate(velocity), np.concatenate(spin)


def _takers(scenario: Scenario, name: str, groups: list[Group], whole: set[str]) -> list[Group]:
    """Those that the particles of a body make room for, where they are `whole`.

    Those that are there already make room for all that is added, and for nothing else.
    """
    there = name in scenario.carried or (scenario.earlier is not None and name in scenario.inflow)
    return [g for g in groups if (g.name not in scenario.carried if there else g.name in whole)]


def _outside(scenario: Scenario, particles: ParticleSet, takers: list[Group]) -> ParticleSet:
    """The particles of a body without the free ones that lie inside others."""
    inside = inside_bodies(scenario, takers, particles.position)
    keep = ~inside | (particles.motion != FREE)
    if keep.all():
        return particles
    return particles.chosen(keep)


def _above_ground(scenario: Scenario, name: str, particles: ParticleSet) -> ParticleSet:
    """The particles of a body without the free ones that lie in the ground of the terrain."""
    assert scenario.bed is not None
    if not len(particles):
        return particles
    distance = ground_of(scenario.bed).height_above(particles.position)
    if name in scenario.carried or name in scenario.inflow:
        buried = (particles.motion == FREE) & (distance < -BURIED * scenario.dp)
        if buried.any():
            raise scenario.where.error(
                ("terrain",),
                f"terrain: {buried.sum()} particles of {name}, which come from the earlier run, "
                f"lie in the ground, up to {-distance.min():.3g} m deep: keep its terrain",
            )
        return particles
    keep = (distance > LEAST_HEIGHT * scenario.dp) | (particles.motion != FREE)
    return particles if keep.all() else particles.chosen(keep)


def body_names(scenario: Scenario) -> list[str]:
    """Bodies first, a file's own body names in place of its own; the terrain; the inflows."""
    names = [each for name in scenario.body for each in scenario.names_of_bodies(name)]
    bed = [] if scenario.terrain is None else [TERRAIN]
    return list(dict.fromkeys([*names, *bed, *scenario.inflow]))
