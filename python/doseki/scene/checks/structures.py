"""Checks of structures whose loads are read: foundations, thin boxes, and the flow that comes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...record.particles import BOUND, FIXED, ParticleSet
from ...scenario.gauges.loads.approach import Approach
from ...scenario.gauges.loads.load import Load
from ...scenario.gauges.loads.metered import Metered
from ...scenario.gauges.loads.panels import Panels
from ...scenario.model import Scenario
from ...scenario.tables.bodies import Box
from ...scenario.tables.mesh import Mesh
from ...util.finding import Finding, place_text
from ..ground import ground_of
from ..kinds.box_walls import SLAB
from ..kinds.mesh import MeshBody
from ..periodic import wrapped

DEEP = 3  # spacings, as far as the kernel sees
DEPTHS = (0.25, 0.75, 1.25, 1.75, 2.4)  # spacings, at which a structure is looked for
SAME = 1e-3  # spacings between two places of one particle
BESIDE = 1.5  # spacings to the neighbours by which an edge is known
ASIDE = 0.3  # sine of the angle between its normal and those on both sides of it
UPWARDS = 0.7  # vertical part of the normal of a crest
NEAR = 0.87  # spacings from a place at which it is still there: inside a lattice, none is farther


@dataclass(frozen=True)
class Shallow(Finding):
    """A structure that does not reach far enough into the ground."""

    gauge: str
    reach: float  # m, where it is least
    at: tuple[float, ...]  # m
    dp: float

    def __str__(self) -> str:
        place = place_text(self.at)
        return (
            f"{self.place}: reaches {self.reach:.2g} m into the ground at ({place}) m; what "
            f"gauge.{self.gauge} reads of water beside it is up to 8 % low: let it go {DEEP} dp = "
            f"{DEEP * self.dp:.3g} m into bed and banks"
        )


@dataclass(frozen=True)
class EndsAtWall(Finding):
    """A structure that ends where the face of a fixed body begins that its gauges do not read."""

    gauges: tuple[str, ...]
    other: str
    at: tuple[float, ...]  # m
    dp: float

    def __str__(self) -> str:
        place = place_text(self.at)
        gauges = " and ".join(f"gauge.{gauge}" for gauge in self.gauges)
        return (
            f"{self.place}: ends at {self.other}, at ({place}) m, whose particles behind its face "
            f"carry the thrust on a quarter of dp there, which {gauges} "
            f"{'does' if len(self.gauges) == 1 else 'do'} not read: {self._remedy}"
        )

    @property
    def _remedy(self) -> str:
        deep = f"{DEEP} dp = {DEEP * self.dp:.3g} m"
        if not self._tank:
            return f"let it go {deep} on, and {self.other} end at its face"
        return (
            f"make the walls of {self._tank} boxes of their own, the sides {deep} deeper than the "
            "floor between them"
        )

    @property
    def _tank(self) -> str:
        """The tank that either of them is a wall of, "" for none."""
        sides = (name.rpartition(".") for name in (self.other, self.place))
        return next((tank for tank, _, side in sides if side[0] in "+-"), "")


@dataclass(frozen=True)
class InWalls(Finding):
    """A mesh that goes into other walls, which keep their particles where it loses its own."""

    gauge: str
    count: int
    all: int
    at: tuple[float, ...]  # m

    def __str__(self) -> str:
        place = place_text(self.at)
        return (
            f"{self.place}: {self.count:,} of its {self.all:,} particles lie in other walls and "
            f"are left out, one at ({place}) m; what gauge.{self.gauge} reads of water beside them "
            "is up to 8 % low: let these walls end at its faces"
        )


@dataclass(frozen=True)
class OneFace(Finding):
    """A thin box, of which the static part of a load sees one face."""

    gauge: str
    layers: float
    dp: float

    def __str__(self) -> str:
        return (
            f"{self.place}: is {self.layers:.2g} dp thick, so that the static part of gauge."
            f"{self.gauge} counts what stands on one face alone, that towards what moves at the "
            f"start: give its `normal` where that is meant, or {SLAB + 0.5:g} dp = "
            f"{(SLAB + 0.5) * self.dp:.3g} m of thickness"
        )


@dataclass(frozen=True)
class BodiesInFlow(Finding):
    """A section that takes bodies which move for the flow that comes to a structure."""

    gauges: tuple[str, ...]  # of the loads that design formulas are for
    bodies: tuple[str, ...]
    liquids: tuple[str, ...]

    def __str__(self) -> str:
        loads = " and ".join(f"gauge.{gauge}" for gauge in self.gauges)
        flow = f'"{self.liquids[0]}"' if len(self.liquids) == 1 else "that of the flow"
        return (
            f"{self.place}: has no `material`, so it counts {_listed(self.bodies)} as flow, and "
            f"the design formulas of {loads} with it: set its `material` to {flow}; `contact` has "
            "what bodies give"
        )


def _listed(bodies: tuple[str, ...]) -> str:
    """Names of tables, of many the first two."""
    named = [f"body.{name}" for name in bodies[:2]]
    more = f" and {len(bodies) - 2} more" if len(bodies) > 2 else ""
    return (", " if more else " and ").join(named) + more


def structure_findings(
    scenario: Scenario, particles: ParticleSet, names: list[str], normal: np.ndarray,
    depth: np.ndarray,
) -> Iterator[Finding]:  # fmt: skip
    """A doubt about each fixed body whose load is read, and each flow that comes to it."""
    yield from _bodies_in_flow(scenario, particles, names)
    faces = _Faces(particles, normal, depth < scenario.dp)
    for name, gauges in _metered_bodies(scenario).items():
        gauge, of_it = gauges[0], _fixed_of(scenario, particles, names, [name])
        if not of_it.any():
            continue
        first_row = faces.is_first[of_it]
        place = particles.position[of_it]
        lost = list(_in_walls(scenario, name, gauge, place))
        yield from lost
        lacking = [each for each in gauges if not isinstance(scenario.gauge[each], Panels)]
        if lacking and not lost and not scenario.is_dry:
            yield from _ends_at_walls(scenario, name, lacking, faces, names)
        if scenario.bed is None:
            continue
        yield from _shallow(scenario, name, gauge, place, normal[of_it], first_row)
        table = scenario.body[name]
        loads = [each for each in gauges if isinstance(scenario.gauge[each], Load)]
        if loads and isinstance(table, Box):
            yield from _one_face(scenario, name, loads[0], table)


def _bodies_in_flow(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> Iterator[Finding]:
    """Looks for sections that take bodies for flow; where there is no liquid, they are the flow."""
    if scenario.is_dry:
        return
    moving = {names[k] for k in np.unique(particles.body[particles.motion == BOUND])}
    bodies = tuple(
        name
        for name, table in scenario.body.items()
        if getattr(table, "clamped", None) is None and moving & set(scenario.names_of_bodies(name))
    )
    loads = {n: gauge for n, gauge in scenario.gauge.items() if isinstance(gauge, Load)}
    for name, section in scenario.gauge.items():
        read = tuple(each for each, load in loads.items() if load.approach == name)
        if bodies and read and isinstance(section, Approach) and section.material is None:
            yield BodiesInFlow(f"gauge.{name}", read, bodies, tuple(scenario.liquids))


def _metered_bodies(scenario: Scenario) -> dict[str, list[str]]:
    """Bodies with the gauges that read what acts on each."""
    found: dict[str, list[str]] = {}
    for name, gauge in scenario.gauge.items():
        for body in gauge.bodies if isinstance(gauge, Metered) else ():
            if body in scenario.body:
                found.setdefault(body, []).append(name)
    return found


def _fixed_of(
    scenario: Scenario, particles: ParticleSet, names: list[str], bodies: Iterable[str]
) -> np.ndarray:
    """Mask (N,) of the fixed particles of some bodies."""
    own = [names.index(each) for body in bodies for each in scenario.names_of_bodies(body)]
    mask: np.ndarray = (particles.motion == FIXED) & np.isin(particles.body, own)
    return mask


def _in_walls(scenario: Scenario, name: str, gauge: str, position: np.ndarray) -> Iterator[Finding]:
    """Looks for the particles of a mesh that others have taken the place of."""
    table = scenario.body[name]
    if not isinstance(table, Mesh) or table.motion is not None:
        return
    from scipy.spatial import cKDTree

    made = MeshBody(scenario, name, table).fill()[0]
    gone = (
        cKDTree(wrapped(scenario, position)).query(wrapped(scenario, made))[0] > SAME * scenario.dp
    )
    if gone.any():
        first = tuple(made[gone][0].tolist())
        yield InWalls(f"body.{name}", gauge, int(gone.sum()), len(made), first)


@dataclass(frozen=True)
class _Faces:
    """What is fixed of all particles, and which of it is the first row of a face."""

    particles: ParticleSet
    normal: np.ndarray  # (N, dim)
    is_first: np.ndarray  # (N,)


def _ends_at_walls(
    scenario: Scenario, name: str, gauges: list[str], faces: _Faces, names: list[str]
) -> Iterator[Finding]:
    """Looks for ends of a body that some of its gauges do not see the whole of."""
    of_it = _fixed_of(scenario, faces.particles, names, [name])
    alike: dict[frozenset[str], list[str]] = {}
    for each in gauges:
        gauge = scenario.gauge[each]
        assert isinstance(gauge, Metered)
        read = [body for body in gauge.bodies if body in scenario.body]
        alike.setdefault(frozenset(read), []).append(each)
    ends: dict[tuple[int, tuple[float, ...]], list[str]] = {}
    for bodies, those in alike.items():
        of_gauge = _fixed_of(scenario, faces.particles, names, bodies)
        if (end := _end_at_wall(scenario.dp, faces, of_it, of_gauge)) is not None:
            ends.setdefault(end, []).extend(those)
    for (body, at), those in ends.items():
        yield EndsAtWall(f"body.{name}", tuple(those), f"body.{names[body]}", at, scenario.dp)


def _end_at_wall(
    dp: float, faces: _Faces, of_it: np.ndarray, of_gauge: np.ndarray
) -> tuple[int, tuple[float, ...]] | None:
    """The other body and the place of an end, m; None for none.

    Looks in each hollow corner that its face makes with that of a body which a gauge does not read
    for what the gauge reads behind.
    """
    from scipy.spatial import cKDTree

    particles, normal = faces.particles, faces.normal
    is_face = (
        (particles.motion == FIXED) & faces.is_first & (np.linalg.norm(normal, axis=1) > ASIDE)
    )
    own, others = np.flatnonzero(is_face & of_it), np.flatnonzero(is_face & ~of_gauge)
    if not len(own) or not len(others):
        return None
    position = particles.position
    near = cKDTree(position[others]).query_ball_point(position[own], BESIDE * dp)
    one = np.repeat(own, [len(each) for each in near])
    other = others[np.concatenate(near).astype(int)]
    apart = position[other] - position[one]
    hollow = (
        ((apart * normal[one]).sum(axis=1) > ASIDE * dp)
        & ((apart * normal[other]).sum(axis=1) < -ASIDE * dp)
        & (np.abs((normal[one] * normal[other]).sum(axis=1)) < ASIDE)
    )
    one, other = one[hollow], other[hollow]
    tree, there = cKDTree(position[of_gauge]), np.ones(len(one), bool)
    for on in DEPTHS[2:]:
        there &= tree.query(position[one] - on * dp * normal[other])[0] < NEAR * dp
    if there.all():
        return None
    k = int(np.argmin(there))
    return int(particles.body[other[k]]), tuple(position[one[k]].tolist())


def _one_face(scenario: Scenario, name: str, gauge: str, box: Box) -> Iterator[Finding]:
    thickness = (box.max - box.min) / scenario.dp
    if box.normal is None and np.count_nonzero(thickness < SLAB + 0.5) == 1:
        yield OneFace(f"body.{name}", gauge, float(thickness.min()), scenario.dp)


def _shallow(
    scenario: Scenario,
    name: str,
    gauge: str,
    position: np.ndarray,
    normal: np.ndarray,
    first_row: np.ndarray,
) -> Iterator[Finding]:
    """Follows the sides of the body down into the ground from where they come out of it.

    From a crest that ends in a bank the way down leads out of its other faces. Where the map knows
    nothing of the ground there is nothing to follow it into.
    """
    assert scenario.bed is not None
    from scipy.spatial import cKDTree

    dp = scenario.dp
    ground, tree = ground_of(scenario.bed), cKDTree(position)
    found = ground.field.nearest(np.ascontiguousarray(position))
    height = found["distance"]
    unknown = ground.field.at(np.ascontiguousarray(position[:, :-1]))["unknown"]
    out = (
        first_row
        & (height > 0)
        & (height < dp)
        & (np.linalg.norm(normal, axis=1) > 0)
        & (unknown == 0)
    )
    if not out.any():
        return
    own = np.flatnonzero(out)
    facing = _faces_over(position, normal, own, tree, dp)
    # Along the face, and along both at an edge: the ground may slope across them.
    down = -found["normal"][own]
    for face in np.moveaxis(facing, 1, 0):
        down = down - (down * face).sum(axis=1)[:, None] * face
    length = np.linalg.norm(down, axis=1)
    # A face that lies on the ground leads nowhere.
    keep = (length > 0.5) & (np.abs(facing[:, 0, -1]) < UPWARDS)
    down = down[keep] / length[keep, None]
    own = own[keep]
    foot = position[own] + height[own, None] * down
    reach, there = np.zeros(len(foot)), np.ones(len(foot), bool)
    for depth in DEPTHS:
        there &= tree.query(foot + depth * dp * down)[0] < NEAR * dp
        reach[there] = (depth + DEPTHS[0]) * dp
    if len(foot) and not there.all():
        least = int(np.argmin(reach))
        at = tuple(foot[least].tolist())
        yield Shallow(f"body.{name}", gauge, float(reach[least]), at, dp)


def _faces_over(
    position: np.ndarray, normal: np.ndarray, chosen: np.ndarray, tree: Any, dp: float
) -> np.ndarray:
    """The normals (k, 2, dim) of the faces over the chosen particles (k,).

    Along an edge a normal is the mean of those of two faces, so that neighbours lean to either side
    of it: theirs are taken, of crest and foot the other alone.  What there is no second of is zero.
    """
    facing = np.zeros((len(chosen), 2, position.shape[1]))
    facing[:, 0] = normal[chosen]
    for faces, each, near in zip(
        facing, chosen, tree.query_ball_point(position[chosen], BESIDE * dp), strict=True
    ):
        aside = normal[near] - np.outer(normal[near] @ normal[each], normal[each])
        length = np.linalg.norm(aside, axis=1)
        along = aside @ (aside[length.argmax()] / max(length.max(), 1e-300))
        if length.max() > ASIDE and along.min() < -ASIDE:
            both = normal[[near[along.argmin()], near[along.argmax()]]]
            faces[:] = _alone(both[np.abs(both[:, -1]) < UPWARDS])
    return facing


def _alone(normals: np.ndarray) -> np.ndarray:
    """Up to two normals (k, dim), the second without its part along the first, then zeros."""
    alone = np.zeros((2, normals.shape[1]))
    alone[: len(normals)] = normals
    alone[1] -= (alone[1] @ alone[0]) * alone[0]
    length = float(np.linalg.norm(alone[1]))
    alone[1] *= 1 / length if length > ASIDE else 0.0
    return alone
