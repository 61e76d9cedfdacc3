"""How far a flow has come on a map, whichever way it goes."""

from __future__ import annotations

import math

import numpy as np

from ..record.reader import Run, Snapshot
from ..scenario.tables.inflow import Inflow
from ..scene.periodic import nearest_image
from .views import LEVEL, tables

AHEAD = 0.01  # share of the mass that is ahead of the front: a stray drop is no front


def goes_along_x(run: Run) -> bool:
    """Whether a flow goes along the first axis: in a plane, and on no terrain where neither
    gravity nor an inflow points across.
    """
    if run.scenario["dim"] == 2:
        return True
    gravity = np.array(run.scenario.get("gravity", [0.0] * 3))
    ways = [gravity, *(inflow.direction for inflow in tables(run, "inflow", Inflow).values())]
    across = any(abs(way[1]) > LEVEL * np.linalg.norm(way) for way in ways)
    return "terrain" not in run.scenario and not across


class Advance:
    """Follows fluid from where each of its particles began: where it was seen first, or the
    section of its inflow.
    """

    def __init__(self, run: Run) -> None:
        dim = run.scenario["dim"]
        self._plan, self._dp = dim - 1, run.scenario["dp"]
        self._period = np.zeros(self._plan)
        for axis, low, high in run.periods():
            if axis < self._plan:
                self._period[axis] = high - low
        sections = tables(run, "inflow", Inflow).items()
        self._sections = {name: np.array(table.position[: self._plan]) for name, table in sections}
        self._id = np.zeros(0, np.int64)
        self._place = np.zeros((0, self._plan))
        self._way = np.zeros((0, self._plan))  # from its start to where it was seen last
        self._farthest = 0.0
        self._begun = False

    def look(self, snapshot: Snapshot, fluid: np.ndarray) -> float:
        """The front in the next snapshot, of which `fluid` (N,) is a mask, m; nan without fluid.

        It is the distance on the map that 1 % of the mass of what has moved, by more than dp, has
        gone beyond, or that has been gone so far; 0 where nothing has moved.
        """
        self._follow(snapshot, fluid)
        if not fluid.any():
            return math.nan
        distance, mass = np.linalg.norm(self._way, axis=1), self._mass
        moved = distance > self._dp
        if moved.any():
            order = np.argsort(-distance[moved], kind="stable")
            ahead = np.cumsum(mass[moved][order])
            first = int(np.searchsorted(ahead, AHEAD * ahead[-1]))
            self._farthest = max(self._farthest, float(distance[moved][order][first]))
        return self._farthest

    def _follow(self, snapshot: Snapshot, fluid: np.ndarray) -> None:
        """Add what each has gone since the last snapshot."""
        order = np.argsort(snapshot["id"][fluid], kind="stable")
        numbers = snapshot["id"][fluid][order]
        place = snapshot["position"][fluid, : self._plan][order]
        self._mass = snapshot["mass"][fluid][order]
        way = self._entered(snapshot["body"][fluid][order], place)
        at = np.searchsorted(self._id, numbers)
        known = at < len(self._id)
        known[known] = self._id[at[known]] == numbers[known]
        before = at[known]
        step = nearest_image(place[known] - self._place[before], self._period)
        way[known] = self._way[before] + step
        self._id, self._place, self._way, self._begun = numbers, place, way, True

    def _entered(self, body: np.ndarray, place: np.ndarray) -> np.ndarray:
        """The way (N, dim - 1) of what is seen for the first time."""
        way = np.zeros_like(place)
        for name, section in self._sections.items() if self._begun else ():
            come = body == name
            way[come] = nearest_image(place[come] - section, self._period)
        return way
