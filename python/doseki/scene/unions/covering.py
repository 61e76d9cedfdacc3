"""What of the faces of fixed bodies others cover: what is buried is no face that fluid meets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ...record.particles import ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.motion import Motion
from ..kinds.body import Body
from ..kinds.box_walls import movers
from ..periodic import nearest_image, periods
from ..shapes import PlaneFaces

AHEAD = (0.01, 0.25, 0.5)  # dp before a face: what is nearer leaves fluid no room
BESIDE = 0.76  # dp, along each axis, to the particles of a wall without a shape
SOME = 100  # particles of a body, which lie in its shape if it has one
MARGIN = 4.0  # dp by which a shape may reach beyond its particles, as a sharp corner does
RESTS = 1e-3  # dp between the sides of bodies that lie on each other
STEEP = 0.64  # cosine of 50 degrees: sides of bodies that meet at less are one smooth surface
LEVEL = 1 - 1e-6  # cosine of an angle that is none


class Slant(NamedTuple):
    """A slanted side of a body that lies on a side of another, over particles of the latter."""

    over: str  # the body that has the slanted side
    middle: np.ndarray  # (dim,) of its extent
    up: np.ndarray  # (dim,) unit normal of the side on which it lies
    normal: np.ndarray  # (dim,) of the slanted side
    rows: np.ndarray  # (n,) of the particles below both
    depth: np.ndarray  # (n,) below the side on which it lies
    foot: np.ndarray  # (n, dim) places on that side above them, beside `middle` over a period
    thickness: np.ndarray  # (n,) of the upper body there, along `normal`

    @property
    def lean(self) -> float:
        """Cosine of the angle between both sides."""
        return float(self.up @ self.normal)

    @property
    def below(self) -> np.ndarray:
        """Depths (n,) of the particles below the slanted side."""
        return np.asarray(self.thickness + self.depth * self.lean)


class Covering:
    """How each of the fixed bodies of a scene lies against those that never part from it.

    A gate that opens covers nothing, and nothing covers it but what moves as it does.
    """

    def __init__(
        self, scenario: Scenario, bodies: Mapping[str, Body[Any]], walls: Mapping[str, np.ndarray]
    ) -> None:
        """`walls` are the positions (n, dim) of the particles of each fixed body."""
        self._scenario, self._bodies, self._walls = scenario, bodies, walls
        self._dp, self._period = scenario.dp, periods(scenario)
        self._faces: dict[str, PlaneFaces | None] = {}
        margin = MARGIN * scenario.dp
        self._ends = {
            name: (wall.min(axis=0) - margin, wall.max(axis=0) + margin)
            for name, wall in walls.items()
        }

    def gaps(self, name: str, faces: PlaneFaces, around: ParticleSet) -> np.ndarray:
        """Depths (n, m) of a body's particles below its faces, infinite where these are covered.

        A covered face counts all the same where a free part of it is nearer than what else the
        fluid may meet: the floor in the corner before a wall that stands on it.  A particle that
        would know no face knows all: no fluid sees it.  `around` are the particles of the scene.
        """
        point = nearest_image(self._walls[name] - faces.place, self._period)
        gaps = faces.gaps(point)
        free = np.logical_not(self._are_covered(name, faces, point))
        nearest = np.where(free & self._may_be_wet(faces, around), gaps, np.inf).min(axis=1)
        known = free.copy()
        for side in np.flatnonzero(~free.all(axis=0)):
            first = free[:, side] & (gaps[:, side] < self._dp)
            places = faces.feet(point[first], np.array([side]))[:, 0]
            known[:, side] |= self._distance(point, places) < nearest
        known |= ~known.any(axis=1)[:, None]
        return np.where(known, gaps, np.inf)

    def slants(self, name: str) -> Iterator[Slant]:
        """Where other bodies lie on sides of this one, and their slanted sides over its particles.

        Of those that a kernel reaches from these sides.
        """
        faces = self._faces_of(name)
        if faces is None:
            return
        point = nearest_image(self._walls[name] - faces.place, self._period)
        gaps = faces.gaps(point)
        for other in self._around(name):
            over = None if other == name else self._faces_of(other)
            if over is None:
                continue
            lean = faces.normals @ over.normals.T
            slanted = ((lean > STEEP) & (lean < LEVEL)).any(axis=1)
            for side in np.flatnonzero(slanted & (lean < -LEVEL).any(axis=1)):
                near = np.flatnonzero(gaps[:, side] < self._scenario.support + self._dp)
                foot = faces.place + point[near] + gaps[near, side, None] * faces.normals[side]
                found = near, gaps[near, side], foot
                yield from self._on_side((name, other), over, faces.normals[side], *found)

    def _faces_of(self, name: str) -> PlaneFaces | None:
        if name not in self._faces:
            self._faces[name] = self._bodies[name].plane_faces()
        return self._faces[name]

    def _on_side(
        self, pair: tuple[str, str], over: PlaneFaces, up: np.ndarray, rows: np.ndarray,
        depth: np.ndarray, foot: np.ndarray,
    ) -> Iterator[Slant]:  # fmt: skip
        """The slants of the second body of a pair over places (n, dim) on a side of the first."""
        offset, lean = nearest_image(foot - over.place, self._period), over.normals @ up
        low, high = over.low.min(axis=0) - self._dp, over.high.max(axis=0) + self._dp
        there = ((offset > low) & (offset < high)).all(axis=1)
        rows, depth, foot, offset = rows[there], depth[there], foot[there], offset[there]
        below = over.gaps(offset)
        rests = (np.abs(below[:, lean < -LEVEL]) < RESTS * self._dp).any(axis=1)
        rests &= (below > -RESTS * self._dp).all(axis=1)
        height = np.where(lean > 0, below / np.maximum(lean, 1e-12), np.inf)
        top = height.argmin(axis=1)
        for side in np.flatnonzero((lean > STEEP) & (lean < LEVEL)):
            own = np.flatnonzero(rests & (top == side))
            place = foot[own] + height[own, side, None] * up
            own = own[~self._is_buried(pair, place, self._dp * over.normals[side])]
            if len(own):
                yield Slant(
                    pair[1], over.place, up, over.normals[side], rows[own], depth[own],
                    over.place + offset[own], below[own, side],
                )  # fmt: skip

    def _is_buried(self, pair: tuple[str, str], place: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Mask (n,) of places on the second of two bodies that a third one covers."""
        buried = np.zeros(len(place), bool)
        for third in self._around(pair[1]):
            if third in pair:
                continue
            near = np.flatnonzero(self._may_meet(third, place, place))
            if len(near):
                buried[near] |= self._are_within(third, place[near], ahead)
        return buried

    def _may_be_wet(self, faces: PlaneFaces, around: ParticleSet) -> np.ndarray:
        """Mask (m,) of faces in front of which something moves, or enters."""
        found = np.stack(list(movers(self._scenario, around)))
        return np.asarray((faces.gaps(found - faces.place) < 0).any(axis=0))

    def _distance(self, point: np.ndarray, places: np.ndarray) -> np.ndarray:
        """From points (n, dim) to the nearest of places; infinite beyond the kernel."""
        if not len(places):
            return np.full(len(point), np.inf)
        near = cKDTree(places).query(point, distance_upper_bound=self._scenario.support)
        return np.asarray(near[0])

    def _are_covered(self, name: str, faces: PlaneFaces, point: np.ndarray) -> np.ndarray:
        """Mask (n, m) of the places on each face above points (n, dim) of a body."""
        covered = np.zeros((len(point), len(faces.normals)), bool)
        for other in self._around(name):
            low, high = faces.place + faces.low, faces.place + faces.high
            sides = np.flatnonzero(self._may_meet(other, low, high))
            place = faces.place + faces.feet(point, sides)
            row, column = np.nonzero(self._may_meet(other, place, place))
            if len(row):
                ahead = self._dp * faces.normals[sides[column]]
                within = self._are_within(other, place[row, column], ahead)
                covered[row, sides[column]] |= within
        return covered

    def _around(self, name: str) -> Iterator[str]:
        """The bodies that stand against it as long as it is there; itself over a period."""
        motion, ends = self._scenario.body[name].prescribed_motion, self._ends[name]
        for other in self._walls:
            itself = other == name and not self._period.any()
            stays = _alike(self._scenario.body[other].prescribed_motion, motion)
            if stays and not itself and self._may_meet(other, *ends):
                yield other

    def _may_meet(self, other: str, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Where the space between ends (..., dim) has a part near the particles of a body."""
        start, end = self._ends[other]
        return np.asarray((((high > start) & (low < end)) | (self._period > 0)).all(axis=-1))

    def _are_within(self, other: str, place: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Mask (N,) of places with a body before them; `ahead` (N, dim) is a spacing long."""
        body, walls = self._bodies[other], self._walls[other]
        if body.encloses(walls[:SOME]).any():
            before = np.concatenate([place + part * ahead for part in AHEAD])
            return np.asarray(body.encloses(before).reshape(len(AHEAD), -1).any(axis=0))
        gap = cKDTree(walls).query(place + 0.5 * ahead, p=np.inf)[0]
        return np.asarray(gap < BESIDE * self._dp)


def _alike(one: Motion | None, other: Motion | None) -> bool:
    """Whether bodies with these motions stay together."""
    if one is None or other is None:
        return one is other
    return all(np.array_equal(value, vars(other)[key]) for key, value in vars(one).items())
