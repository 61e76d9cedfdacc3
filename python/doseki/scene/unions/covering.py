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
    up: np.ndarray  # (dim,) unit normal of the side on which it lies
    normal: np.ndarray  # (dim,) of the slanted side
    rows: np.ndarray  # (n,) of the particles below both
    depth: np.ndarray  # (n,) below the side on which it lies
    below: np.ndarray  # (n,) below the slanted side

    @property
    def lean(self) -> float:
        """Cosine of the angle between both sides."""
        return float(self.up @ self.normal)


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

    def slants(self, name: str, faces: PlaneFaces) -> Iterator[Slant]:
        """Where other bodies lie on sides of this one and thin to nothing there."""
        point = nearest_image(self._walls[name] - faces.place, self._period)
        gaps = faces.gaps(point)
        side, rows = gaps.argmin(axis=1), np.arange(len(point))
        depth, ups = gaps[rows, side], faces.normals[side]
        foot = faces.place + point + depth[:, None] * ups
        for other in self._around(name):
            over = self._bodies[other].plane_faces()
            if over is None or other == name:
                continue
            below = over.gaps(nearest_image(foot - over.place, self._period))
            lean = ups @ over.normals.T
            rests = ((np.abs(below) < RESTS * self._dp) & (lean < -LEVEL)).any(axis=1)
            rests &= (below > -RESTS * self._dp).all(axis=1)
            top = np.where(lean > 0, below / np.maximum(lean, 1e-12), np.inf).argmin(axis=1)
            rests &= (lean[rows, top] > STEEP) & (lean[rows, top] < LEVEL)
            here = np.flatnonzero(rests)
            for pair in np.unique(np.stack([side[here], top[here]]), axis=1).T:
                own = here[(side[here] == pair[0]) & (top[here] == pair[1])]
                up, normal = faces.normals[pair[0]], over.normals[pair[1]]
                under = below[own, pair[1]] + depth[own] * (up @ normal)
                yield Slant(other, up, normal, own, depth[own], under)

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
