"""Where what has left a run on a terrain went: beyond the map, into its holes, into outflows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ...geodata.ground import Profile
from ...geodata.raster import Raster
from ...record.particles import BOUND, FREE
from ...record.reader import Run, Snapshot
from ...scenario.tables.region import Outflow
from ..views import tables

EDGE, HOLE, OUTFLOW = "edge", "no_data", "outflow"  # ways out, in the order of _Exits
WAYS = (EDGE, HOLE, OUTFLOW)
SIDES = {1: ("left", "right"), 2: ("western", "eastern", "southern", "northern")}
KEYS = ("id", "position", "velocity", "mass", "motion")
LOOKS = 64  # along the way of a particle after it was seen last
FAR = 2.0  # intervals of snapshots that it is followed for
SLACK = 0.5  # of the length of that way, by which its height is not known


@dataclass(frozen=True)
class Left:
    """What left a run on a terrain, but through its ground, kg (2-D: kg/m).

    Attributes:
        edge: over the edge of the map.
        no_data: into cells without data.
        outflow: into outflows of the scenario.
        side: by which most of `edge` went, one of SIDES.
        hole: where `no_data` went on the map, a mean, m.
        unseen: all of it, where no snapshot has anything of what left.

    """

    edge: float
    no_data: float
    outflow: float
    side: str = ""
    hole: tuple[float, ...] = ()
    unseen: float = 0.0


class _Gone(NamedTuple):
    """Particles that were there in one snapshot and not in the next."""

    position: np.ndarray  # (N, dim) m
    velocity: np.ndarray
    mass: np.ndarray
    interval: np.ndarray  # (N,) s, to the next snapshot


def what_left(run: Run, mass: float) -> Left | None:
    """How `mass`, kg, of which no more is known, shares out; None where none left, or without a
    terrain.

    A particle goes on from where it was seen last, as fast as it was there, and left by the first
    way out on its way, else by the nearest one. So shares are rough where snapshots are rare.
    """
    ground = run.ground
    if ground is None or not mass > 0:
        return None
    gone = _gone(run)
    if not len(gone.mass):
        return Left(0.0, 0.0, 0.0, unseen=mass)
    exits = _Exits(run, ground)
    way, place = exits.taken(gone)
    share = mass / gone.mass.sum()
    edge, hole, outflow = (float(gone.mass[way == k].sum() * share) for k in range(len(WAYS)))
    side = exits.side_of(place[way == 0], gone.mass[way == 0]) if edge else ""
    middle = np.average(place[way == 1], axis=0, weights=gone.mass[way == 1]) if hole else ()
    return Left(edge, hole, outflow, side, tuple(float(x) for x in middle))


def _gone(run: Run) -> _Gone:
    """What moves and is missing in the next snapshot, of all snapshots."""
    dim = run.scenario["dim"]
    found = [_Gone(np.zeros((0, dim)), np.zeros((0, dim)), np.zeros(0), np.zeros(0))]
    before: Snapshot | None = None
    for snapshot in run:
        snapshot.prefetch(KEYS)
        if before is not None:
            moves = np.isin(before["motion"], (FREE, BOUND))
            lost = moves & ~np.isin(before["id"], snapshot["id"])
            lost &= np.isfinite(before["position"] + before["velocity"]).all(axis=1)
            position, velocity = before["position"][lost], before["velocity"][lost]
            after = np.full(int(lost.sum()), snapshot.time - before.time)
            found.append(_Gone(position, velocity, before["mass"][lost], after))
        before = snapshot
    return _Gone(*(np.concatenate(column) for column in zip(*found, strict=True)))


class _Exits:
    """The ways out of a run on a terrain."""

    def __init__(self, run: Run, ground: Raster | Profile) -> None:
        self._ground, self._dp = ground, run.scenario["dp"]
        self._outflows: Sequence[Outflow] = [*tables(run, "outflow", Outflow).values()]
        self._low, self._high = _extent(ground)
        for axis, _, _ in run.periods():  # has no edge
            if axis < len(self._low):
                self._low[axis], self._high[axis] = -np.inf, np.inf

    def taken(self, gone: _Gone) -> tuple[np.ndarray, np.ndarray]:
        """Of each particle the way out (N,), an index of WAYS, and where (N, dim - 1), m."""
        count, plan = gone.position.shape[0], gone.position.shape[1] - 1
        way, place = np.full(count, -1), gone.position[:, :plan].copy()
        for k in range(LOOKS + 1):
            still = np.flatnonzero(way < 0)
            if not len(still):
                return way, place
            time = FAR * gone.interval[still] * k / LOOKS
            step = gone.velocity[still] * time[:, None]
            found = self._at(gone.position[still] + step, np.linalg.norm(step, axis=1))
            out = found >= 0
            way[still[out]] = found[out]
            place[still[out]] = (gone.position[still] + step)[out, :plan]
        rest = way < 0
        way[rest] = np.argmin(self._distances(place[rest]), axis=0)
        return way, place

    def _at(self, position: np.ndarray, gone: np.ndarray) -> np.ndarray:
        """The way out (N,) at places (N, dim), -1 where there is none; they are `gone` m away."""
        place, found = position[:, :-1], np.full(len(position), -1)
        found[self._is_unknown(place)] = 1
        found[((place < self._low) | (place > self._high)).any(axis=1)] = 0
        slack = 2 * self._dp + SLACK * gone
        for outflow in self._outflows:
            low, high = outflow.min, outflow.max
            within = ((place >= low[:-1]) & (place <= high[:-1])).all(axis=1)
            height = position[:, -1]
            found[within & (height > low[-1] - slack) & (height < high[-1] + slack)] = 2
        return found

    def _is_unknown(self, place: np.ndarray) -> np.ndarray:
        """Whether places (N, 1 or 2) lie in cells without data."""
        if isinstance(self._ground, Profile):
            return np.zeros(len(place), bool)
        row, column, inside = self._ground.cells_at(place[:, 0], place[:, 1])
        inside[inside] = np.isnan(self._ground.values[row[inside], column[inside]])
        return inside

    def _distances(self, place: np.ndarray) -> np.ndarray:
        """How far each way out is from places, (3, N), m."""
        edge = np.minimum(place - self._low, self._high - place).min(axis=1)
        hole, outflow = np.full(len(place), np.inf), np.full(len(place), np.inf)
        if isinstance(self._ground, Raster) and np.isnan(self._ground.values).any():
            row, column = np.nonzero(np.isnan(self._ground.values))
            cells = np.column_stack([self._ground.x[column], self._ground.y[row]])
            hole = cKDTree(cells).query(place)[0]
        for each in self._outflows:
            low, high = each.min[:-1], each.max[:-1]
            apart = np.maximum(0.0, np.maximum(low - place, place - high))
            outflow = np.minimum(outflow, np.linalg.norm(apart, axis=1))
        return np.stack([edge, hole, outflow])

    def side_of(self, place: np.ndarray, mass: np.ndarray) -> str:
        """The side of the map by which most of these went."""
        beyond = np.stack([self._low - place, place - self._high], axis=-1)  # (N, axes, 2)
        nearest = np.argmax(beyond.reshape(len(place), -1), axis=1)
        return SIDES[len(self._low)][int(np.argmax(np.bincount(nearest, mass)))]


def _extent(ground: Raster | Profile) -> tuple[np.ndarray, np.ndarray]:
    """The ends of the map along the horizontal axes, m."""
    if isinstance(ground, Raster):
        west, south, east, north = ground.extent
        return np.array([west, south]), np.array([east, north])
    half = 0.5 * (ground.x[1] - ground.x[0])
    return np.array([ground.x[0] - half]), np.array([ground.x[-1] + half])
