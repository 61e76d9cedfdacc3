"""Bodies that move and what they touch: rigid bodies of the resolved scheme from a scenario."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .elastic_bodies import is_elastic
from .lattice import rotated
from .packing import PackingError, pack, solid_fraction
from .particles import FIXED, ParticleSet
from .periodic import nearest_image, periods, wrapped
from .scenario import Scenario
from .schema import Box, Disc, Grains, Mesh, ParticleFile, Points, Polygon, ShapedBody, TurnedBody
from .schemes import RESOLVED
from .solid_shapes import Ball, Convex, Particles, ShapeError, box_shape, mesh_shape, polygon_shape

Shape = Ball | Convex
SOLID_SHAPES = (Grains, Polygon, Mesh)  # whose particles are those of bodies also where fixed
PACKING = {2: 0.75, 3: 0.55}  # solid fraction of a box filled with grains
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Group:
    """The n rigid bodies of one named body."""

    name: str
    shapes: list[Shape]
    shape: np.ndarray  # (n,) index into shapes
    centre: np.ndarray  # (n, dim), m
    orientation: np.ndarray  # (n, 4) quaternion w, x, y, z
    material: str
    fixed: bool = False
    single: bool = False  # one particle each
    elastic: bool = False  # deformable

    def __len__(self) -> int:
        return len(self.centre)


def is_grain(scenario: Scenario, body: Any) -> bool:
    """Whether [body.NAME] is made of bodies that move."""
    if scenario.scheme != RESOLVED or isinstance(body, ParticleFile) or body.fixed:
        return False
    return scenario.materials[body.material].law == "solid"


def is_made_of_bodies(scenario: Scenario, body: Any) -> bool:
    """Whether the particles of [body.NAME] are those of its bodies, moving or fixed."""
    return is_grain(scenario, body) or isinstance(body, SOLID_SHAPES)


def is_single(body: ShapedBody) -> bool:
    """Whether each of its bodies is one particle."""
    return body.kinematics == "single" or getattr(body, "fill", None) == "single"


def build_group(scenario: Scenario, name: str) -> Group:
    """The bodies of a body for which `is_made_of_bodies`; raises UserError."""
    body = scenario.body[name]
    build: dict[type, Callable[..., Group]] = {
        Grains: _packed,
        Disc: _ball,
        Box: _box,
        Polygon: _polygon,
        Mesh: _mesh,
        Points: _points,
    }
    group = build[type(body)](scenario, name, body)
    return replace(group, single=is_single(body), elastic=is_elastic(body))


def _group(body: ShapedBody, name: str, shape: Shape, centre: np.ndarray, **other: Any) -> Group:
    """A body of one piece."""
    index = np.zeros(1, np.int32)
    orientation = other.pop("orientation", UPRIGHT)[None, :]
    return Group(name, [shape], index, centre[None, :], orientation, body.material, body.fixed)


def _ball(scenario: Scenario, name: str, body: Disc) -> Group:
    pivot = body.centre if body.pivot is None else body.pivot
    centre = rotated(body.centre[None, :], body.rotate, pivot, body.rotate_axis)[0]
    return _group(body, name, Ball(body.radius, scenario.dim), centre)


def _box(scenario: Scenario, name: str, body: Box) -> Group:
    if not np.all(body.max > body.min):
        message = f"body.{name}: every entry of min must be below that of max"
        raise scenario.where.error(("body", name, "max"), message)
    pivot = body.min if body.pivot is None else body.pivot
    centre = rotated(0.5 * (body.min + body.max)[None, :], body.rotate, pivot, body.rotate_axis)[0]
    return _group(
        body, name, box_shape(body.max - body.min), centre, orientation=turn(scenario, body)
    )


def _polygon(scenario: Scenario, name: str, body: Polygon) -> Group:
    try:
        shape, centre = polygon_shape(np.array(body.vertices))
    except ShapeError as error:
        raise scenario.where.error(("body", name, "vertices"), f"body.{name}: {error}") from None
    pivot = centre if body.pivot is None else body.pivot
    centre = rotated(centre[None, :], body.rotate, pivot)[0]
    return _group(body, name, shape, centre, orientation=turn(scenario, body))


def _mesh(scenario: Scenario, name: str, body: Mesh) -> Group:
    keys = ("body", name, "file")
    file = scenario.where.folder(keys) / body.file
    if not file.is_file():
        raise scenario.where.error(keys, f"body.{name}.file: there is no file {file}")
    try:
        shape, centre = mesh_shape(file, body.scale)
    except ShapeError as error:
        raise scenario.where.error(keys, f"body.{name}: {error}") from None
    centre = centre if body.centre is None else body.centre
    pivot = centre if body.pivot is None else body.pivot
    centre = rotated(centre[None, :], body.rotate, pivot, body.rotate_axis)[0]
    return _group(body, name, shape, centre, orientation=turn(scenario, body))


def _points(scenario: Scenario, name: str, body: Points) -> Group:
    """Each particle a ball of its mass."""
    measure = body.mass / scenario.materials[body.material].rho0
    unit = Ball(1.0, scenario.dim).measure
    ball = Ball((measure / unit) ** (1 / scenario.dim), scenario.dim)
    centre = np.array(body.position)
    n = len(centre)
    upright = np.tile(UPRIGHT, (n, 1))
    return Group(name, [ball], np.zeros(n, np.int32), centre, upright, body.material)


def turn(scenario: Scenario, body: TurnedBody) -> np.ndarray:
    """The quaternion of `rotate`; the axes are those of lattice.rotation_matrix."""
    half = 0.5 * np.radians(body.rotate)
    axis = np.array([0.0, 0.0, 1.0] if scenario.dim == 2 else [0.0, -1.0, 0.0])
    if body.rotate_axis is not None:
        axis = body.rotate_axis / np.linalg.norm(body.rotate_axis)
    return np.array([np.cos(half), *(np.sin(half) * axis)])


def matrices(orientation: np.ndarray, dim: int) -> np.ndarray:
    """Rotation matrices (n, dim, dim) of quaternions (n, 4)."""
    w, x, y, z = orientation.T
    full = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.moveaxis(full, 2, 0)[:, :dim, :dim]


def _packed(scenario: Scenario, name: str, body: Grains) -> Group:
    """Grains at random in the box, up to the level where they have the solid fraction asked."""
    random = np.random.default_rng(body.random_seed)
    diameters, kind = _sizes(scenario, name, body)
    kind = random.permutation(kind)
    radius, high = 0.5 * diameters[kind], body.max.copy()
    fraction = solid_fraction(radius, body.min, high)
    if (body.count or body.mass_total) and body.packing is not None:
        high[-1] = body.min[-1] + fraction / body.packing * (high[-1] - body.min[-1])
        if high[-1] > body.max[-1] * (1 + 1e-9 * np.sign(body.max[-1])):
            raise _unreachable(scenario, name, body.packing, fraction, len(kind), "needed")
        fraction = body.packing
    try:
        centre = pack(radius, body.min, high, body.random_seed)
    except PackingError as error:
        raise _unreachable(scenario, name, fraction, error.reached, len(kind), "reached") from None
    pivot = body.min if body.pivot is None else body.pivot
    centre = rotated(centre, body.rotate, pivot, body.rotate_axis)
    shapes: list[Shape] = [Ball(0.5 * d, scenario.dim, body.wetted) for d in diameters]
    upright = np.tile(UPRIGHT, (len(kind), 1))
    return Group(name, shapes, kind.astype(np.int32), centre, upright, body.material, body.fixed)


def _unreachable(
    scenario: Scenario, name: str, asked: float, got: float, count: int, verb: str
) -> Exception:
    why = {
        "needed": f"body.{name}: {count} grains at a solid fraction of {asked:.3g} do not fit into "
        f"the box, whose fraction would have to be {got:.3g}: make it larger",
        "reached": f"body.{name}: {count} grains do not pack to a solid fraction of {asked:.3g} in "
        f"this box; {got:.3g} was reached: lower packing, or make the box larger",
    }[verb]
    return scenario.where.error(("body", name), why)


def _sizes(scenario: Scenario, name: str, body: Grains) -> tuple[np.ndarray, np.ndarray]:
    """Diameters, and which of them each grain has."""
    rows = np.array(body.grading or [[body.d, 1.0]])
    diameters, share = rows[:, 0], rows[:, 1] / rows[:, 1].sum()
    measure = np.array([Ball(0.5 * d, scenario.dim).measure for d in diameters])
    mean = 1 / (share / measure).sum()  # of a grain: numbers are mass over mass of a grain
    space = float(np.prod(body.max - body.min))
    total = space * (body.packing or PACKING[scenario.dim])
    if body.mass_total is not None:
        slice_width = body.width if scenario.dim == 2 else 1.0
        total = body.mass_total / slice_width / scenario.materials[body.material].rho0
    numbers = (body.count or total / mean) * mean * share / measure
    whole = np.floor(numbers).astype(int)
    missing = round(numbers.sum()) - whole.sum()
    whole[np.argsort(whole - numbers, kind="stable")[:missing]] += 1
    if whole.sum() == 0:
        message = f"body.{name}: not one grain of d = {diameters.min():g} m fits its mass or box"
        raise scenario.where.error(("body", name), message)
    return diameters, np.repeat(np.arange(len(diameters)), whole)


def particles_of(group: Group, spacing: float, dim: int) -> tuple[Particles, np.ndarray]:
    """Particles of all bodies of a group where they stand, and the body of each within it."""
    parts: list[Particles] = []
    owners: list[np.ndarray] = []
    turns = matrices(group.orientation, dim)
    for k, shape in enumerate(group.shapes):
        own = _own_particles(group, shape, spacing)
        which = np.flatnonzero(group.shape == k)
        turned = np.einsum("nab,pb->npa", turns[which], own.position)
        normal = np.einsum("nab,pb->npa", turns[which], own.normal)
        position = (group.centre[which][:, None, :] + turned).reshape(-1, dim)
        depth = np.tile(own.depth, len(which))
        parts.append(Particles(position, normal.reshape(-1, dim), depth))
        owners.append(np.repeat(which, len(own.depth)))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    joined = [np.concatenate(arrays)[order] for arrays in zip(*parts, strict=True)]
    return Particles(*joined), owner[order]


def _own_particles(group: Group, shape: Shape, spacing: float) -> Particles:
    """The particles of one body in its frame."""
    if group.single:
        return shape.single()
    if group.elastic and isinstance(shape, Ball) and shape.dim == 2:
        return shape.hexagonal(spacing)
    return shape.particles(spacing)


def inside_bodies(scenario: Scenario, group: Group, position: np.ndarray) -> np.ndarray:
    """Whether each position (N, dim) lies inside a body of the group."""
    from scipy.spatial import cKDTree

    inside = np.zeros(len(position), bool)
    if not len(position):
        return inside
    period = periods(scenario)
    tree = cKDTree(wrapped(scenario, position), boxsize=period)
    for k, turned in enumerate(matrices(group.orientation, scenario.dim)):
        shape = group.shapes[group.shape[k]]
        near = np.array(tree.query_ball_point(group.centre[k], shape.reach), dtype=np.int64)
        offset = nearest_image(position[near] - group.centre[k], period)
        inside[near[shape.contains(offset @ turned)]] = True
    return inside


def contact_groups(scenario: Scenario, names: list[str], particles: ParticleSet) -> Iterator[Group]:
    """What fixed bodies without bodies of their own are for those that touch them.

    A whole box is a convex body, a disc or sphere a ball; of points, of what a file holds and of
    what `where` or `count` leaves of a shape, each particle is a ball of its spacing.
    """
    for name in names:
        body = scenario.body.get(name)
        if body is not None and is_made_of_bodies(scenario, body):
            continue
        whole = isinstance(body, Box | Disc) and body.fixed and body.where is None
        if whole and not getattr(body, "count", None):
            build = _box if isinstance(body, Box) else _ball
            yield replace(build(scenario, name, body), fixed=True)
            continue
        mine = (particles.body == names.index(name)) & (particles.motion == FIXED)
        if mine.any():
            yield from _grit(scenario, name, particles, mine)


def _grit(
    scenario: Scenario, name: str, particles: ParticleSet, mine: np.ndarray
) -> Iterator[Group]:
    """One ball for each particle."""
    rho0 = np.array([scenario.materials[m].rho0 for m in scenario.material_names])
    kinds = particles.material[mine]
    spacing = (particles.mass[mine] / rho0[kinds]) ** (1 / scenario.dim)
    sizes, which = np.unique(np.round(spacing, 12), return_inverse=True)
    for material in np.unique(kinds):
        of_it = kinds == material
        yield Group(
            name,
            [Ball(0.5 * size, scenario.dim) for size in sizes],
            which[of_it].astype(np.int32),
            particles.position[mine][of_it],
            np.tile(UPRIGHT, (int(of_it.sum()), 1)),
            scenario.material_names[material],
            fixed=True,
        )
