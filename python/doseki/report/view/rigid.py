"""Rigid bodies that move as shapes: balls, and hulls of what their particles fill."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from ...figures.space.box import is_round
from ...measure.census.grains import keep_their_shape
from ...record.quantities import CATEGORIES
from ...record.reader import Run, Snapshot
from ...scene.groups import matrices
from .box import Box
from .coding import packed, wide
from .colours import SPEED, Field
from .particles import Block

BALL = -1  # in place of the index of a hull
MOST_HULLS = 400
KNOWN = (SPEED, *CATEGORIES)  # fields that a body has


@dataclass
class RigidShapes:
    """Shape, radius (m) and material of each body by its row; bodies that have none are not drawn.

    A hull is a pair: points (n, 3) in the axes of the body, m, and triangles (m, 3).
    """

    shape: list[int] = field(default_factory=list)
    radius: list[float] = field(default_factory=list)
    material: list[int] = field(default_factory=list)
    hulls: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    drawn: list[bool] = field(default_factory=list)

    def of_bodies(self, snapshot: Snapshot) -> np.ndarray:
        """Mask (N,) of the particles of bodies that are drawn as shapes."""
        known = np.array([*self.drawn, False])
        grain = snapshot["grain"]
        mask: np.ndarray = known[np.where(grain < len(self.drawn), grain, -1)] & (grain >= 0)
        return mask

    def as_json(self, fields: Sequence[Field]) -> dict[str, Any]:
        """For the page."""
        meshes = [
            {"points": np.round(points, 7).tolist(), "triangles": triangles.ravel().tolist()}
            for points, triangles in self.hulls
        ]
        return {
            "shape": self.shape,
            "radius": [float(f"{r:.6g}") for r in self.radius],
            "meshes": meshes,
            "fields": [each.name for each in fields if each.name in KNOWN],
        }

    def block(self, snapshot: Snapshot, box: Box, fields: Sequence[Field]) -> Block:
        """Places, turns and colours of the bodies in a snapshot."""
        table, count = snapshot.grains, len(self.shape)
        there = np.arange(count) < len(table["position"])
        rows = np.minimum(np.arange(count), len(table["position"]) - 1)
        position = np.full((count, 3), 0.5)
        position[:, : box.dim] = box.share(table["position"][rows])
        if box.dim == 2:
            position[:, 2] = 0.9  # before all particles
        inside = np.all((position >= 0) & (position <= 1), axis=1)
        there &= inside & (table["removed"][rows] == 0) & np.array(self.drawn, bool)
        turn = wide(0.5 + 0.5 * table["orientation"][rows])
        speeds = np.linalg.norm(table["velocity"][rows], axis=1)
        names = {name: k for k, name in enumerate(snapshot.body_names)}
        known = {
            SPEED: speeds,
            "material": np.array(self.material),
            "body": np.array([names[str(name)] for name in table["body"][rows]]),
        }
        colours = [each.share(known[each.name]) for each in fields if each.name in KNOWN]
        planes = [*wide(np.nan_to_num(position)).T, *turn.T, there.astype(np.uint8), *colours]
        return Block(count, packed(planes), count)


def rigid_shapes(run: Run, snapshot: Snapshot) -> RigidShapes | None:
    """The shapes of the bodies that move, from a snapshot with all their particles.

    None where no body is drawn as a shape: those that deform are drawn as their particles.
    """
    table = snapshot.grains
    if not len(table.get("position", ())):
        return None
    shapes = RigidShapes()
    particles = _by_grain(snapshot["grain"], len(table["position"]))
    material = snapshot.stored("material")
    turns = matrices(table["orientation"], snapshot.dim)
    rigid = keep_their_shape(run, snapshot)
    for k, is_ball in enumerate(is_round(run, snapshot)[:-1]):
        own = particles[k]
        hull = None
        if rigid[k] and not is_ball and len(shapes.hulls) < MOST_HULLS:
            offset = (snapshot["position"][own] - table["position"][k]) @ turns[k]
            volume = (snapshot["mass"] / snapshot["density"])[own]
            hull = _hull(offset, volume)
        # A body of one particle has no other shape than its ball.
        drawn = is_ball or hull is not None or len(own) <= 1
        shapes.drawn.append(bool(drawn and rigid[k]))
        shapes.shape.append(BALL if hull is None else len(shapes.hulls))
        shapes.radius.append(0.5 * float(table["diameter"][k]))
        shapes.material.append(int(material[own[0]]) if len(own) else 0)
        if hull is not None:
            shapes.hulls.append(hull)
    return shapes if any(shapes.drawn) else None


def _by_grain(grain: np.ndarray, count: int) -> list[np.ndarray]:
    """The particles of each body."""
    order = np.argsort(grain, kind="stable")
    ends = np.searchsorted(grain[order], np.arange(count + 1))
    return [order[ends[k] : ends[k + 1]] for k in range(count)]


def _hull(offset: np.ndarray, volume: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The convex hull of particles (n, dim), moved outwards by half of their spacing.

    None where they are too few for one, or in one plane.
    """
    dim = offset.shape[1]
    if len(offset) <= dim or not np.isfinite(offset).all():
        return None
    try:
        inner = ConvexHull(offset)
        sides = np.unique(np.round(inner.equations, 6), axis=0)
        sides[:, -1] -= 0.5 * float(np.median(volume)) ** (1 / dim)
        corners = HalfspaceIntersection(sides, offset.mean(axis=0)).intersections
        outer = ConvexHull(corners)
    except (QhullError, ValueError):
        return None
    if dim == 2:
        ring = np.pad(corners[outer.vertices], ((0, 0), (0, 1)))
        fan = [(0, k, k + 1) for k in range(1, len(ring) - 1)]
        return ring, np.array(fan)
    return corners, outer.simplices
