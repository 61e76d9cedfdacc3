"""Bodies of a scenario, turned into particles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .elastic_bodies import ElasticBody
from .errors import ResourceError
from .expressions import ExpressionError, evaluate_at, is_expression
from .grain_checks import resolution_warnings
from .grain_overlaps import check_overlaps
from .grains import (
    Group,
    build_group,
    contact_groups,
    inside_bodies,
    is_made_of_bodies,
    is_single,
    particles_of,
)
from .lattice import ball_measure, box_counts, box_lattice, disc_lattice, rotated
from .memory import available_bytes
from .overlaps import describe_overlaps
from .particle_checks import check_particles
from .particles import BOUND, FIXED, FREE, ParticleSet, concatenate
from .periodic import wrapped
from .rigid_bodies import Bodies
from .scenario import Scenario
from .schema import Box, Disc, Grains, LatticeBody, ParticleFile, Points, ShapedBody
from .solid_shapes import Particles
from .wetting import covered_share

MAX_PARTICLES = 2_000_000_000
BYTES_PER_PARTICLE = 500  # what a run holds, lists included


Settle = Callable[[Scenario, list[Group], list[str]], list[Group]]


@dataclass(frozen=True)
class Scene:
    """What a run starts from: particles, the names of their bodies, and rigid bodies."""

    particles: ParticleSet
    names: list[str]
    bodies: Bodies


def build_bodies(scenario: Scenario) -> tuple[ParticleSet, list[str]]:
    """The particles of all bodies, and the names their `body` indices stand for.

    The names of the inflows come last; no particle has them yet.  Overlaps are reported in
    `scenario.warnings`.  Raises UserError, or ResourceError when there are too many particles.
    Grains stand as they were packed.
    """
    scene = build_scene(scenario)
    return scene.particles, scene.names


def build_scene(scenario: Scenario, settle: Settle | None = None) -> Scene:
    """The particles and rigid bodies of a scenario; see `build_bodies`.

    `settle` moves bodies to where they come to rest: from all of them, those that stay last, and
    the names of bodies to all of them.
    """
    _check_size(scenario)
    names = _body_names(scenario)
    parts = {
        name: _from_file(scenario, name, names)
        if isinstance(body, ParticleFile)
        else _from_shape(scenario, name, names)
        for name, body in scenario.body.items()
        if not is_made_of_bodies(scenario, body)
    }
    made = [
        build_group(scenario, name)
        for name, body in scenario.body.items()
        if is_made_of_bodies(scenario, body)
    ]
    groups = sorted(made, key=lambda group: group.fixed)
    moves = any(not group.fixed for group in groups)
    if moves:
        groups += contact_groups(scenario, names, concatenate(list(parts.values()), scenario.dim))
        scenario.warnings.extend(resolution_warnings(scenario, groups))
        check_overlaps(scenario, groups)
        groups = settle(scenario, groups, names) if settle is not None else groups
    scene = _with_bodies(scenario, names, parts, groups, moves)
    check_particles(scenario, scene.particles, names)
    scenario.warnings.extend(describe_overlaps(scene.particles, names))
    return scene


def _with_bodies(
    scenario: Scenario,
    names: list[str],
    parts: dict[str, ParticleSet],
    groups: list[Group],
    moves: bool,
) -> Scene:
    """Joins the parts in the order of the scenario; fluid makes room for bodies."""
    dim = scenario.dim
    sets: list[ParticleSet] = []
    tables: list[tuple[np.ndarray, ...]] = []  # grain, shaped, normal, depth
    kept = [group for group in groups if not group.elastic] if moves else []
    first = dict(zip((g.name for g in kept), _first_indices(kept), strict=True))
    elastic: list[ElasticBody] = []
    of_name = {g.name: g for g in reversed(groups)}
    for name, body in scenario.body.items():
        if name in parts:
            sets.append(_outside(scenario, parts[name], groups))
            n = len(sets[-1])
            none = np.full(n, -1, np.int32), np.zeros(n, bool), np.zeros((n, dim)), np.zeros(n)
            tables.append(none)
            continue
        group = of_name[name]
        placed, owner = particles_of(group, body_spacing(scenario, body), dim)
        if group.elastic:
            elastic += _elastic_bodies(scenario, group, placed, owner, sum(map(len, sets)))
        sets.append(_of_bodies(scenario, group, names, placed.position, owner))
        n = len(owner)
        grain = np.full(n, -1) if group.fixed or group.elastic else first[name] + owner
        tables.append((grain.astype(np.int32), np.ones(n, bool), placed.normal, placed.depth))
    particles = concatenate(sets, dim)
    empty = np.zeros(0, np.int32), np.zeros(0, bool), np.zeros((0, dim)), np.zeros(0)
    grain, shaped, normal, depth = (np.concatenate(c) for c in zip(empty, *tables, strict=True))
    velocity, spin = _velocities(scenario, kept)
    bodies = Bodies(kept, velocity, spin, grain, shaped, normal, depth, elastic)
    return Scene(particles, names, bodies)


def _elastic_bodies(
    scenario: Scenario, group: Group, placed: Particles, owner: np.ndarray, first: int
) -> list[ElasticBody]:
    """The deformable bodies of a group, whose particles are numbered from `first`."""
    body = scenario.body[group.name]
    clamped = np.zeros(len(owner), bool)
    if body.clamped is not None:
        clamped = field_of(scenario, group.name, "clamped", body.clamped, placed.position) > 0
    made = []
    for k in range(len(group)):
        own = np.flatnonzero(owner == k)
        volume = group.shapes[group.shape[k]].measure / len(own)
        spacing = volume ** (1 / scenario.dim)
        surface = placed.depth[own] < spacing
        made.append(ElasticBody(group.name, first + own, spacing, clamped[own], surface))
    return made


def body_spacing(scenario: Scenario, body: ShapedBody) -> float:
    """The spacing of a body's particles, m."""
    return getattr(body, "dp", None) or scenario.dp


def _first_indices(groups: list[Group]) -> list[int]:
    """The index of the first body of each group."""
    ends = np.cumsum([0, *(len(group) for group in groups)])
    return [int(end) for end in ends[:-1]]


def _velocities(scenario: Scenario, groups: list[Group]) -> tuple[np.ndarray, np.ndarray]:
    """Velocities (n, dim) and spins (n, 3) of bodies at the start."""
    dim = scenario.dim
    velocity, spin = [np.zeros((0, dim))], [np.zeros((0, 3))]
    for group in groups:
        body = scenario.body.get(group.name)
        given = np.zeros_like(group.centre)
        if isinstance(body, ShapedBody):
            given = _velocity(scenario, group.name, body, group.centre)
        velocity.append(given)
        spin.append(np.tile(_spin(body), (len(group), 1)))
    return np.concatenate(velocity), np.concatenate(spin)


def _spin(body: object) -> np.ndarray:
    given = getattr(body, "spin", None)
    if given is None:
        return np.zeros(3)
    return np.array([0.0, 0.0, given]) if np.ndim(given) == 0 else np.asarray(given, float)


def _of_bodies(
    scenario: Scenario, group: Group, names: list[str], position: np.ndarray, owner: np.ndarray
) -> ParticleSet:
    """The particles of bodies, which share the mass of each equally."""
    body, n, dim = scenario.body[group.name], len(owner), scenario.dim
    rho0 = scenario.materials[group.material].rho0
    measure = np.array([shape.measure for shape in group.shapes])[group.shape]
    wet = np.array([shape.wet_measure for shape in group.shapes])[group.shape]
    mass = (rho0 * measure / np.bincount(owner, minlength=len(group)))[owner]
    density = rho0 * (measure / wet)[owner]
    arm = position - group.centre[owner]
    spin = _spin(body)
    turning = np.cross(spin, np.pad(arm, ((0, 0), (0, 3 - dim))))[:, :dim]
    where = position if group.elastic else group.centre[owner]
    return ParticleSet(
        position=wrapped(scenario, position),
        velocity=_velocity(scenario, group.name, body, where) + turning,
        mass=mass,
        density=density,
        smoothing_length=np.full(n, scenario.eta * scenario.dp),
        material=np.full(n, scenario.material_names.index(group.material), np.int32),
        body=np.full(n, names.index(group.name), np.int32),
        motion=np.full(n, FIXED if group.fixed else BOUND, np.int32),
        id=np.arange(n, dtype=np.int64),
    )


def _outside(scenario: Scenario, particles: ParticleSet, groups: list[Group]) -> ParticleSet:
    """The particles without the free ones that lie inside a body that moves."""
    inside = np.zeros(len(particles), bool)
    for group in groups:
        if not group.fixed:
            inside |= inside_bodies(scenario, group, particles.position)
    keep = ~inside | (particles.motion != FREE)
    if keep.all():
        return particles
    return ParticleSet(**{name: values[keep] for name, values in vars(particles).items()})


def _body_names(scenario: Scenario) -> list[str]:
    """Bodies first, a file's own body names in place of the name of the file's body."""
    names: list[str] = []
    for name in scenario.body:
        table = scenario.particle_tables.get(name)
        names += table.body_names if table is not None and table.body is not None else [name]
    return list(dict.fromkeys([*names, *scenario.inflow]))


def _check_size(scenario: Scenario) -> None:
    """Refuse what cannot be held, before anything is allocated."""
    counts = {name: _count(scenario, name) for name in scenario.body}
    total, free = sum(counts.values()), available_bytes()
    if total > MAX_PARTICLES or total * BYTES_PER_PARTICLE > free:
        largest = max(counts, key=lambda name: counts[name])
        raise ResourceError(
            f"the scenario asks for {total:.3g} particles ({counts[largest]:.3g} of them in "
            f"body.{largest}), about {total * BYTES_PER_PARTICLE / 2**30:.3g} GiB; at most "
            f"{min(MAX_PARTICLES, free / BYTES_PER_PARTICLE):.3g} fit: increase dp"
        )


def _count(scenario: Scenario, name: str) -> float:
    """How many particles a body will have (a disc on a lattice: its bounding box)."""
    body = scenario.body[name]
    if is_made_of_bodies(scenario, body):
        return _count_of_bodies(scenario, body)
    if isinstance(body, Box):
        full = float(np.prod(box_counts(body.min, body.max, body.dp or scenario.dp)))
        return min(full, body.count or full)
    if isinstance(body, Disc):
        across = 2 * body.radius / (body.dp or scenario.dp) + 3
        return across**scenario.dim if body.fill == "lattice" else 1
    if isinstance(body, Points):
        return len(body.position)
    return len(scenario.particle_tables[name])


def _count_of_bodies(scenario: Scenario, body: ShapedBody) -> float:
    """At most, or nearly: the space that bodies can take over that of a particle."""
    cell = body_spacing(scenario, body) ** scenario.dim
    if is_single(body) or isinstance(body, Points):
        return len(getattr(body, "position", ())) or 1
    if isinstance(body, Disc):
        return ball_measure(body.radius, scenario.dim) / cell + 1
    if isinstance(body, Box | Grains):
        return float(np.prod(body.max - body.min)) / cell
    return 0.0


def _from_shape(scenario: Scenario, name: str, names: list[str]) -> ParticleSet:
    """Particles of a box, a disc or points, at reference density."""
    body = scenario.body[name]
    rho0 = scenario.materials[body.material].rho0
    position, mass = _fill(scenario, name, body, rho0)
    n = len(position)
    masses, rest = np.full(n, mass), np.full(n, rho0)
    compressed = 1 + _compression(scenario, name, body, position)
    return ParticleSet(
        position=position,
        velocity=_velocity(scenario, name, body, position),
        mass=masses * compressed,
        density=rest * compressed - _missing_cover(scenario, body, n),
        smoothing_length=smoothing_length(scenario, masses, rest),
        material=np.full(n, scenario.material_names.index(body.material), np.int32),
        body=np.full(n, names.index(name), np.int32),
        motion=np.full(n, FIXED if body.fixed else FREE, np.int32),
        id=np.arange(n, dtype=np.int64),
    )


def _fill(scenario: Scenario, name: str, body: ShapedBody, rho0: float) -> tuple[np.ndarray, float]:
    """Positions (N, dim) and the mass of each particle."""
    if isinstance(body, Points):
        return np.array(body.position), body.mass
    spacing = body.dp or scenario.dp
    mass = rho0 * spacing**scenario.dim
    if isinstance(body, Box):
        position, pivot = _box(scenario, name, body, spacing), body.min
    elif body.fill == "lattice":
        position, pivot = disc_lattice(body.centre, body.radius, spacing), body.centre
    else:
        position, pivot = body.centre[None, :].copy(), body.centre
        mass = rho0 * ball_measure(body.radius, scenario.dim)
    if body.jitter:
        random = np.random.default_rng(body.random_seed)
        position += body.jitter * spacing * random.uniform(-1.0, 1.0, position.shape)
    position = _rotated(scenario, name, body, position, pivot)
    return _kept(scenario, name, body, position), body.mass_per_particle or mass


def _kept(scenario: Scenario, name: str, body: LatticeBody, position: np.ndarray) -> np.ndarray:
    """The positions where the body's `where` is above zero."""
    if body.where is None:
        return position
    kept = position[field_of(scenario, name, "where", body.where, position) > 0]
    if not len(kept):
        message = f"body.{name}.where: it is above zero at no particle of the body"
        raise scenario.where.error(("body", name, "where"), message)
    return kept


def _compression(
    scenario: Scenario, name: str, body: ShapedBody, position: np.ndarray
) -> np.ndarray:
    """rho/rho0 - 1 of the initial pressure, p = c^2 (rho - rho0) with the c of the run."""
    if body.pressure is None:
        return np.zeros(len(position))
    pressure = field_of(scenario, name, "pressure", body.pressure, position)
    stiffness = _stiffness(scenario, body.material)
    if (pressure <= -stiffness).any():
        message = (
            f"body.{name}.pressure: {pressure.min():.4g} Pa is more tension than "
            f"rho0 c^2 = {stiffness:.4g} Pa allows"
        )
        raise scenario.where.error(("body", name, "pressure"), message)
    return pressure / stiffness


def _stiffness(scenario: Scenario, material: str) -> float:
    """rho0 c^2 with the sound speed of the run, Pa."""
    scaled = scenario.materials[material].scaled(scenario.xi)
    return scaled.rho0 * scaled.speedsound**2


def _missing_cover(scenario: Scenario, body: ShapedBody, n: int) -> np.ndarray:
    """What the cover of a wetted box, not there yet, will add to the density of its particles."""
    if not isinstance(body, Box) or body.wetted_by is None:
        return np.zeros(n)
    spacing = body.dp or scenario.dp
    upright = box_lattice(body.min, box_counts(body.min, body.max, spacing), spacing, n)
    share = covered_share(body.max[-1] - upright[:, -1], spacing, scenario.support, scenario.dim)
    return scenario.materials[body.wetted_by].rho0 * share


def _box(scenario: Scenario, name: str, body: Box, spacing: float) -> np.ndarray:
    counts = box_counts(body.min, body.max, spacing)
    if not (counts >= 1).all():
        raise scenario.where.error(
            ("body", name, "max"),
            f"body.{name}: the box from {body.min.tolist()} to {body.max.tolist()} is less than "
            f"one particle thick (dp = {spacing:g} m)",
        )
    full = int(np.prod(counts))
    if body.count is not None and body.count > full:
        raise scenario.where.error(
            ("body", name, "count"),
            f"body.{name}.count = {body.count}: the box holds only {full} particles",
        )
    return box_lattice(body.min, counts, spacing, body.count or full)


def _rotated(
    scenario: Scenario, name: str, body: LatticeBody, position: np.ndarray, pivot: np.ndarray
) -> np.ndarray:
    axis = body.rotate_axis
    if axis is not None and (scenario.dim == 2 or not np.any(axis)):
        raise scenario.where.error(
            ("body", name, "rotate_axis"),
            f"body.{name}.rotate_axis = {axis.tolist()}: only a 3-D run has one, other than zero",
        )
    return rotated(position, body.rotate, pivot if body.pivot is None else body.pivot, axis)


def _velocity(scenario: Scenario, name: str, body: ShapedBody, position: np.ndarray) -> np.ndarray:
    """Initial velocities (N, dim): numbers, or expressions of the position."""
    velocity = np.zeros_like(position)
    for axis, entry in enumerate(body.velocity or []):
        velocity[:, axis] = field_of(scenario, name, "velocity", entry, position)
    return velocity


def field_of(
    scenario: Scenario, name: str, key: str, entry: float | str, position: np.ndarray
) -> np.ndarray:
    """A number, or an expression of the position, at each of the positions."""
    if not is_expression(entry):
        return np.full(len(position), float(entry))
    try:
        return evaluate_at(entry, scenario.constants, position)
    except ExpressionError as error:
        raise scenario.where.error(("body", name, key), f"body.{name}.{key}: {error}") from None


def _from_file(scenario: Scenario, name: str, names: list[str]) -> ParticleSet:
    """Particles as a file gives them; smoothing lengths by eq. 10 where it gives none."""
    table, index = scenario.particle_tables[name], {b: i for i, b in enumerate(names)}
    n = len(table)
    materials = np.array([scenario.material_names.index(m) for m in table.material_names])
    bodies, body = [name], np.zeros(n, np.int32)
    if table.body is not None:
        bodies, body = table.body_names, table.body
    fixed = np.full(n, scenario.body[name].fixed) if table.fixed is None else table.fixed
    h = table.smoothing_length
    return ParticleSet(
        position=table.position,
        velocity=table.velocity,
        mass=table.mass,
        density=table.density,
        smoothing_length=smoothing_length(scenario, table.mass, table.density) if h is None else h,
        material=materials[table.material].astype(np.int32),
        body=np.array([index[b] for b in bodies], np.int32)[body],
        motion=np.where(fixed, FIXED, FREE).astype(np.int32),
        id=np.arange(n, dtype=np.int64),
    )


def smoothing_length(scenario: Scenario, mass: np.ndarray, density: np.ndarray) -> np.ndarray:
    """h = eta (m/rho)^(1/dim) (eq. 10)."""
    return scenario.eta * (mass / density) ** (1 / scenario.dim)
