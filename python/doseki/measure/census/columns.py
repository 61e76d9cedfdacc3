"""Columns of plan in which the census takes depths, the bed, and the front of the water."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .grains import Grains, Surroundings

COLUMN = 2.0  # diameters: width of the columns
FRONT_STRETCH = 5  # columns, over which the water is that of a flow


@dataclass(frozen=True)
class Plan:
    """Where the columns are: those of the first snapshot with grains hold for a whole run."""

    origin: np.ndarray  # (dim - 1,) m, a corner of one of them
    width: float  # m


def plan_of(grains: Grains, around: Surroundings) -> Plan:
    """Columns COLUMN mean diameters wide, from the lowest corner of what flows: a wall, or none."""
    dim = grains.position.shape[1]
    spacing = around.water_volume ** (1 / dim)
    low = [around.water[:, :-1] - 0.5 * spacing[:, None]]
    low.append(grains.position[:, :-1] - 0.5 * grains.diameter[:, None])
    return Plan(np.concatenate(low).min(axis=0), COLUMN * float(grains.diameter.mean()))


class Columns:
    """Water, grains and the bed in each of the columns that has any of them."""

    def __init__(self, grains: Grains, around: Surroundings, plan: Plan) -> None:
        """Side walls in a column are no bed, and no part of its area."""
        self.width, self._around = plan.width, around
        every = [around.water, around.fixed, grains.position]
        place = (np.concatenate(every)[:, :-1] - plan.origin) / plan.width
        self.keys, index = np.unique(np.floor(place + 1e-9), axis=0, return_inverse=True)
        self.keys = self.keys.astype(np.int64)
        ends = np.cumsum([len(part) for part in every])[:-1]
        self._of_water, self._of_fixed, self.of_grain = np.split(index.ravel(), ends)
        tall, walled = self._side_walls(grains, place)
        area, n = plan.width ** place.shape[1] * (1 - walled), len(self.keys)
        self.water = np.bincount(self._of_water, around.water_volume, n) / area
        self.depth = self.water + np.bincount(self.of_grain, grains.volume, n) / area
        self.bed = self._highest_fixed(~tall)
        lost = np.isneginf(self.bed)  # nothing fixed but walls
        self.bed[lost] = self._highest_fixed(np.ones(len(tall), bool))[lost]

    def _top(self) -> np.ndarray:
        return self._around.fixed[:, -1] + 0.5 * self._around.fixed_spacing

    def _highest_fixed(self, mask: np.ndarray) -> np.ndarray:
        """The top (n,) of the highest of the fixed particles of a mask in each column, m."""
        bed = np.full(len(self.keys), -math.inf)
        np.maximum.at(bed, self._of_fixed[mask], self._top()[mask])
        return bed

    def _side_walls(self, grains: Grains, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mask (k,) of the fixed particles of side walls; their share (n,) of each column.

        Columns are cut into strips as wide as fixed particles or somewhat more.  A side wall is
        where a strip is higher than all that flows in its column; its area counts where nothing
        flows in the strip.
        """
        water, fixed = len(self._around.water), len(self._around.fixed)
        if not fixed:
            return np.zeros(0, bool), np.zeros(len(self.keys))
        cuts = max(1, math.floor(self.width / float(self._around.fixed_spacing.max()) + 1e-6))
        cells = np.floor(place * cuts + 1e-6).astype(np.int64)
        strips, strip = np.unique(cells, axis=0, return_inverse=True)
        of_water, of_fixed, of_grain = np.split(strip.ravel(), [water, water + fixed])
        surface = np.full(len(self.keys), -math.inf)
        np.maximum.at(surface, self._of_water, self._around.water[:, -1])
        np.maximum.at(surface, self.of_grain, grains.position[:, -1] + 0.5 * grains.diameter)
        top = np.full(len(strips), -math.inf)
        np.maximum.at(top, of_fixed, self._top())
        tall = top[of_fixed] > surface[self._of_fixed]
        empty = np.ones(len(strips), bool)
        empty[of_water], empty[of_grain] = False, False
        _, first = np.unique(of_fixed, return_index=True)  # a particle of each strip
        first = first[tall[first] & empty[of_fixed[first]]]
        count = np.bincount(self._of_fixed[first], minlength=len(self.keys))
        share = count / cuts ** place.shape[1]
        return tall, np.where(np.isneginf(surface), 0.0, np.minimum(share, 0.9))

    def front(self, direction: int, min_depth: float) -> float:
        """Where the foremost water is, along the first axis, of the last column of a flow, m.

        There the water is deeper than `min_depth`, and so it is on the mean over FRONT_STRETCH
        columns from there upstream; spray ahead of a flow is not part of it.  nan: no flow.
        """
        along = direction * self.keys[:, 0]
        depth = np.zeros(int(np.ptp(along)) + 1)
        np.maximum.at(depth, along - along.min(), self.water)
        wet = np.flatnonzero(depth)
        if not len(wet):
            return math.nan
        total = np.concatenate([[0.0], np.cumsum(depth[wet[0] :])])
        end = np.arange(1, len(total))
        start = np.maximum(end - FRONT_STRETCH, 0)
        mean = (total[end] - total[start]) / (end - start)
        flow = np.flatnonzero((depth[wet[0] :] > min_depth) & (mean > min_depth))
        if not len(flow):
            return math.nan
        last = along.min() + wet[0] + flow[-1] == along[self._of_water]
        x = self._around.water[last]
        half = 0.5 * self._around.water_volume[last] ** (1 / x.shape[1])
        return float(direction * (direction * x[:, 0] + half).max())
