"""Bodies that start inside one another or inside walls, and those that may meet images."""

from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...scenario.model import Scenario
from ...scenario.tables.terrain.terrain import TERRAIN
from ...util.finding import Finding, no_less_than
from ..ground import ground_of
from ..groups import Group, boxes, matrices
from ..meeting import meeting_pairs
from ..periodic import periods
from ..shapes import Ball, Convex, MeshShape

SPANS = 1e-6  # of a period: what is as long but for rounding spans it


@dataclass(frozen=True)
class TouchesItself(Finding):
    """Bodies that may touch their own images."""

    diameter: float  # of the largest, m
    axis: str
    period: float  # m
    enough: float  # period, m

    def __str__(self) -> str:
        return (
            f"{self.place}: bodies up to {self.diameter:.3g} m across may touch their own images, "
            f"{self.period:.3g} m away along {self.axis}, which do not act on them: make the "
            f"domain at least {no_less_than(self.enough)} m long there, or the bodies smaller"
        )


@dataclass(frozen=True)
class TouchesTwice(Finding):
    """A ball and a body of another shape that may touch on both sides at once."""

    other: str
    diameters: tuple[float, float]  # m
    axis: str
    period: float  # m

    def __str__(self) -> str:
        one, two = self.diameters
        return (
            f"{self.place}: a ball of {one:.3g} m and one of {self.other} of {two:.3g} m may touch "
            f"on both sides at once in a period of {self.period:.3g} m along {self.axis}, where "
            f"only the nearer side counts: make the domain at least {no_less_than(one + two)} m "
            "long there, or the bodies smaller"
        )


class _Ball(NamedTuple):
    name: str
    fixed: bool
    centre: np.ndarray  # (n, dim)
    radius: float


class Block(NamedTuple):
    """A convex body with sides, in place; lengths in m."""

    name: str
    fixed: bool
    centre: np.ndarray  # (dim,)
    normal: np.ndarray  # (m, dim)
    offset: np.ndarray  # (m,) of the planes, normal.x <= offset inside
    corners: np.ndarray  # (faces, dim, dim)
    samples: np.ndarray  # (n, dim) points of its edges
    reach: float


class _Mesh(NamedTuple):
    name: str
    shape: MeshShape
    centre: np.ndarray  # (3,)
    turned: np.ndarray  # (3, 3)
    samples: np.ndarray  # (n, 3) points of its edges

    def distance(self, position: np.ndarray) -> np.ndarray:
        """Of positions (n, 3) from its surface, m; below 0 inside."""
        return -self.shape.wall((position - self.centre) @ self.turned, 1.0)[1]


def check_overlaps(
    scenario: Scenario, groups: list[Group], in_turn: Set[str] = frozenset()
) -> None:
    """Raise UserError where a body that moves overlaps another by more than contacts may.

    Of those with names `in_turn`, one is not there where another is now.
    """
    groups = _with_images(scenario, groups)
    balls = [ball for group in groups for ball in _balls(group)]
    blocks = [block for group in groups for block in blocks_of(group, scenario)]
    meshes = [mesh for group in groups for mesh in _meshes(group, scenario)]
    allowed = scenario.contact.overlap
    for name, other, overlap, size in [
        *_overlaps(balls, blocks),
        *_with_meshes(balls, blocks, meshes),
        *_with_ground(scenario, balls, blocks),
    ]:
        if {name, other} <= scenario.carried:
            continue  # as deep as contacts have let them
        if name != other and {name, other} <= in_turn:
            continue
        if overlap > allowed * size and not _is_held_by(scenario, name, other):
            whom = "another of its own" if name == other else other
            raise scenario.where.error(
                ("body", name),
                f"body.{name}: a body of it overlaps {whom} by {overlap:.3g} m at the start; "
                f"allowed: {allowed:g} of its size (contact.overlap), {allowed * size:.3g} m; "
                "move one of them apart, or make one smaller",
            )


def _with_images(scenario: Scenario, groups: list[Group]) -> list[Group]:
    """The groups, and for each what reaches over an end of the domain once more at the other."""
    seen = list(groups)
    for axis, period in enumerate(periods(scenario)):
        low, high = scenario.ends_of(axis) if period > 0 else (-np.inf, np.inf)
        for group in list(seen):
            along, reach = group.centre[:, axis], 0.5 * _diameters(group)
            step = np.zeros(group.centre.shape[1])
            step[axis] = period
            seen += [
                _moved(group, which, sign * step)
                for which, sign in ((along - reach < low, 1), (along + reach > high, -1))
                if which.any()
            ]
    return seen


def _moved(group: Group, which: np.ndarray, step: np.ndarray) -> Group:
    return replace(
        group,
        shape=group.shape[which],
        centre=group.centre[which] + step,
        orientation=group.orientation[which],
    )


def period_findings(scenario: Scenario, groups: list[Group]) -> Iterator[Finding]:
    """Doubts about bodies that are large against a period, of which contacts miss some.

    Raises UserError where a body that moves overlaps its own image from the start.
    """
    for axis, period in enumerate(periods(scenario)):
        if period > 0:
            _refuse_longer(scenario, groups, axis, period)
            yield from _met_images(groups, "xyz"[axis], period, scenario.dp)
            yield from _met_twice(groups, axis, period)


def _refuse_longer(scenario: Scenario, groups: list[Group], axis: int, period: float) -> None:
    for group in groups:
        if group.fixed or group.name in scenario.carried:
            continue
        low, high = boxes(group)
        length = (high - low)[:, axis].max(initial=0.0)
        if length > period * (1 + SPANS):
            raise scenario.where.error(
                ("body", group.name),
                f"body.{group.name}: a body of it is {length:.3g} m long along {'xyz'[axis]} and "
                f"overlaps its own image, {period:.3g} m away: make it shorter, or the domain "
                "longer",
            )


def _met_images(groups: list[Group], axis: str, period: float, spacing: float) -> Iterator[Finding]:
    for group in groups:
        diameter = _diameters(group).max(initial=0.0)
        if not group.fixed and diameter > period - spacing:
            yield TouchesItself(group.name, diameter, axis, period, diameter + spacing)


def _met_twice(groups: list[Group], axis: int, period: float) -> Iterator[Finding]:
    """The largest two, of which one moves; what is fixed and spans the period has no sides.

    Two balls touch with all of their images, and points of other shapes with the one that is near.
    """
    bodies = [_largest(group, axis, period) for group in groups if not group.elastic]
    balls = [(group, ball) for group, ball, _ in bodies if ball > 0]
    others = [(group, other) for group, _, other in bodies if other > 0]
    pairs = [
        (one + two, group.name, other.name, (one, two))
        for group, one in balls
        for other, two in others
        if not (group.fixed and other.fixed)
    ]
    both, name, other_name, diameters = max(pairs, default=(0.0, "", "", (0.0, 0.0)))
    if both > period * (1 + SPANS):
        yield TouchesTwice(name, other_name, diameters, "xyz"[axis], period)


def _largest(group: Group, axis: int, period: float) -> tuple[Group, float, float]:
    """The largest extents of its balls and of its bodies of other shapes, m; 0: none."""
    low, high = boxes(group)
    across = (high - low)[:, axis] if group.fixed else _diameters(group)
    across = np.where(group.fixed & (across > period * (1 - SPANS)), 0.0, across)
    is_ball = np.array([isinstance(shape, Ball) for shape in group.shapes])[group.shape]
    ball, other = (float(across[of].max(initial=0.0)) for of in (is_ball, ~is_ball))
    return group, ball, other


def _diameters(group: Group) -> np.ndarray:
    """Of the balls (n,) around the bodies, m: their extent whichever way they turn."""
    return 2 * np.array([shape.reach for shape in group.shapes])[group.shape]


def _is_held_by(scenario: Scenario, name: str, other: str) -> bool:
    """Whether a body is clamped and may therefore lie in what holds it."""
    body, holder = scenario.body.get(name), scenario.body.get(other)
    clamped = body is not None and body.given("clamped") is not None
    return clamped and (other == TERRAIN or (holder is not None and holder.fixed))


Overlap = tuple[str, str, float, float]  # of a body that moves, with, by m, its size in m


def _overlaps(balls: list[_Ball], blocks: list[Block]) -> Iterator[Overlap]:
    for ball in balls:
        if not ball.fixed:
            yield from _of_balls(ball, ball)
    for one, other in _near(balls, blocks):
        if one.fixed and other.fixed:
            continue
        if isinstance(one, Block):
            assert isinstance(other, Block)
            yield from _of_blocks(one, other)
        elif isinstance(other, Block):
            yield from _of_ball_and_block(one, other)
        else:
            yield from _of_balls(one, other)


def _near(balls: list[_Ball], blocks: list[Block]) -> Iterator[tuple[_Ball | Block, _Ball | Block]]:
    """Pairs that may overlap, balls first."""
    if not balls and not blocks:
        return
    ends = [(ball.centre.min(axis=0), ball.centre.max(axis=0), ball.radius) for ball in balls]
    ends += [(block.centre, block.centre, block.reach) for block in blocks]
    low, high = (np.array([end[k] for end in ends]) for k in (0, 1))
    reach = np.array([end[2] for end in ends])[:, None]
    solids: list[_Ball | Block] = [*balls, *blocks]
    for first, second in meeting_pairs(low - reach, high + reach):
        yield solids[first], solids[second]


def _of_blocks(first: Block, second: Block) -> Iterator[Overlap]:
    if float(np.linalg.norm(first.centre - second.centre)) > first.reach + second.reach:
        return
    moving, other_name = (second, first.name) if first.fixed else (first, second.name)
    size = min(block.reach for block in (first, second) if not block.fixed)
    yield moving.name, other_name, _common_width(first, second), 2 * size


def _balls(group: Group) -> Iterator[_Ball]:
    for k, shape in enumerate(group.shapes):
        if isinstance(shape, Ball):
            centre = group.centre[group.shape == k]
            if len(centre):
                yield _Ball(group.name, group.fixed, centre, shape.radius)


def _with_ground(scenario: Scenario, balls: list[_Ball], blocks: list[Block]) -> Iterator[Overlap]:
    """What moves and lies in the ground of a terrain."""
    if scenario.bed is None:
        return
    ground = ground_of(scenario.bed)
    for ball in balls:
        if not ball.fixed:
            deepest = ball.radius - ground.height_above(ball.centre).min()
            yield ball.name, TERRAIN, float(deepest), 2 * ball.radius
    for block in blocks:
        if not block.fixed:
            deepest = -ground.height_above(block.samples).min()
            yield block.name, TERRAIN, float(deepest), 2 * block.reach


def _with_meshes(balls: list[_Ball], blocks: list[Block], meshes: list[_Mesh]) -> Iterator[Overlap]:
    for mesh in meshes:
        for ball in balls:
            if not ball.fixed:
                worst = ball.radius - mesh.distance(ball.centre).min()
                yield ball.name, mesh.name, float(worst), 2 * ball.radius
        for block in blocks:
            if not block.fixed:
                inside = (block.offset - mesh.samples @ block.normal.T).min(axis=1)
                worst = max(-mesh.distance(block.samples).min(), inside.max(initial=-np.inf))
                yield block.name, mesh.name, float(worst), 2 * block.reach


def _meshes(group: Group, scenario: Scenario) -> Iterator[_Mesh]:
    for k, turned in enumerate(matrices(group.orientation, scenario.dim)):
        shape = group.shapes[group.shape[k]]
        if isinstance(shape, MeshShape):
            samples = shape.samples(scenario.dp) @ turned.T + group.centre[k]
            yield _Mesh(group.name, shape, group.centre[k], turned, samples)


def blocks_of(group: Group, scenario: Scenario) -> Iterator[Block]:
    """Those among the bodies of a group."""
    for k, turned in enumerate(matrices(group.orientation, scenario.dim)):
        shape = group.shapes[group.shape[k]]
        if isinstance(shape, Convex):
            centre, (normal, distance) = group.centre[k], shape.planes
            normal = normal @ turned.T
            corners = shape.vertices[shape.faces] @ turned.T + centre
            samples = shape.samples(scenario.dp) @ turned.T + centre
            offset = distance + normal @ centre
            yield Block(
                group.name, group.fixed, centre, normal, offset, corners, samples, shape.reach
            )


def _of_balls(one: _Ball, other: _Ball) -> Iterator[Overlap]:
    """The worst overlap of two sets of balls."""
    from scipy.spatial import cKDTree

    reach = one.radius + other.radius
    if one is other:
        pairs = cKDTree(one.centre).query_pairs(reach, output_type="ndarray")
        gap = np.linalg.norm(one.centre[pairs[:, 0]] - one.centre[pairs[:, 1]], axis=1)
        worst = reach - gap.min(initial=np.inf)
    else:
        worst = reach - cKDTree(other.centre).query(one.centre)[0].min()
    moving, still = (other, one) if one.fixed else (one, other)
    yield moving.name, still.name, float(worst), 2 * moving.radius


def _of_ball_and_block(ball: _Ball, block: Block) -> Iterator[Overlap]:
    beyond = (ball.centre @ block.normal.T - block.offset).max(axis=1)
    near = beyond < ball.radius
    if near.any():
        distance = np.where(
            beyond[near] > 0, _distance(ball.centre[near], block.corners), beyond[near]
        )
        worst = float(ball.radius - distance.min())
        if ball.fixed:
            yield block.name, ball.name, worst, 2 * block.reach
        else:
            yield ball.name, block.name, worst, 2 * ball.radius


def _distance(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Distance (n,) of points to the nearest of the segments or triangles (m, dim, dim)."""
    if points.shape[1] == 2:
        start, side = faces[:, 0], faces[:, 1] - faces[:, 0]
        along = ((points[:, None] - start) * side).sum(axis=2) / (side**2).sum(axis=1)
        nearest = start + np.clip(along, 0, 1)[..., None] * side
        return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)
    from trimesh.triangles import closest_point

    distances = [
        np.linalg.norm(closest_point(np.tile(face, (len(points), 1, 1)), points) - points, axis=1)
        for face in faces
    ]
    return np.min(distances, axis=0)


def _common_width(one: Block, other: Block) -> float:
    """Diameter of the largest ball that lies in both, m; below zero where they are apart."""
    from scipy.optimize import linprog

    normal = np.concatenate([one.normal, other.normal])
    offset = np.concatenate(
        [one.offset - one.normal @ one.centre, other.offset - other.normal @ one.centre]
    )
    rows = np.column_stack([normal, np.ones(len(normal))])
    aim = np.append(np.zeros(normal.shape[1]), -1.0)
    found = linprog(aim, A_ub=rows, b_ub=offset, bounds=(None, None))
    return 2 * float(-found.fun)
