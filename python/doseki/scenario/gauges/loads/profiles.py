"""What is along vertical lines, many at once: how full of water, bodies, walls, and how dense."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....record.particles import BOUND, FIXED
from ..gauge import Setting, State
from ..near import INSIDE, MIN_VOID, REACH, kernel

STEP = 0.5  # spacings between two looks along a line
CAPPED = 0.75  # share of walls around a point from which on a line ends there
WITHIN = 0.5  # share of walls, or bodies, at their surface; beyond it no flow ends by itself
UNDER = 2  # looks below such a point, in which none does either
MOST_LOOKS = 2_000_000  # of particles at heights, at once in memory


@dataclass(frozen=True)
class Profiles:
    """Shares of the space at heights of k lines, from below upwards."""

    height: np.ndarray  # (m,) m, `STEP` apart
    filled: np.ndarray  # (k, m) by water, of the space that walls and bodies leave
    wall: np.ndarray  # (k, m)
    body: np.ndarray  # (k, m) by bodies that move
    density: np.ndarray  # (k, m) of the water there, kg/m3

    def weight(self, line: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Integral (n,) of the density of lines between heights, kg/m2; beyond ends it stays."""
        mean = 0.5 * (self.density[:, 1:] + self.density[:, :-1]) * np.diff(self.height)
        sums = np.pad(np.cumsum(mean, axis=1), ((0, 0), (1, 0)))
        x = self.height
        below, above = (
            self.density[line, 0] * np.minimum(0.0, end - x[0])
            + self._between(sums, line, end)
            + self.density[line, -1] * np.maximum(0.0, end - x[-1])
            for end in (low, high)
        )
        return np.asarray(above - below)

    def is_wet(self, line: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Whether there is water on lines at heights (n,)."""
        inside = height <= self.height[-1]
        return np.asarray(inside & (self._between(self.filled, line, height) >= INSIDE))

    def is_in_body(self, line: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Whether a body that moves is on lines at heights (n,): it tells of no water."""
        inside = height <= self.height[-1]
        return np.asarray(inside & (self._between(self.body, line, height) > WITHIN))

    def level(self, line: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Where the water that is at heights (n,) ends above them.

        It goes on through bodies that move; nan where one of these, or a wall, is the end of it.
        """
        in_body = self.body > WITHIN
        gone, capped = (self.filled < INSIDE) & ~in_body, self.wall > CAPPED
        capped |= gone & (self.wall > WITHIN)
        for above in range(1, UNDER + 1):  # flows end before walls do
            capped[:, :-above] |= gone[:, :-above] & (self.wall[:, above:] > CAPPED)
        m = len(self.height)
        ends = np.where(gone | capped, np.arange(m), m)
        first_from = np.minimum.accumulate(ends[:, ::-1], axis=1)[:, ::-1]
        first_from = np.pad(first_from, ((0, 0), (0, 1)), constant_values=m)
        first = first_from[line, np.searchsorted(self.height, height, side="right")]
        last = np.minimum(first, m - 1)
        ended = (first < m) & ~capped[line, last] & ~in_body[line, np.maximum(last - 1, 0)]
        return np.where(ended, np.maximum(height, self._crossings(line, last)), np.nan)

    def _crossings(self, line: np.ndarray, k: np.ndarray) -> np.ndarray:
        """Heights (n,) at which flows end between the looks k - 1 and k."""
        below = np.maximum(k - 1, 0)
        before, now = self.filled[line, below], self.filled[line, k]
        drop = np.where(before > INSIDE, before - now, 1.0)
        share = np.where(before > INSIDE, before - INSIDE, 0.0) / np.where(drop == 0, 1.0, drop)
        return np.asarray(self.height[below] + share * (self.height[k] - self.height[below]))

    def _between(self, values: np.ndarray, line: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Values (k, m) of lines, linear between heights; beyond the ends those there."""
        at = np.interp(height, self.height, np.arange(len(self.height)))
        k = np.minimum(at.astype(int), len(self.height) - 2)
        return np.asarray(values[line, k] + (at - k) * (values[line, k + 1] - values[line, k]))


@dataclass(frozen=True)
class _Beside:
    """Particles beside lines, in pairs: one of many particles with each of their lines."""

    line: np.ndarray  # (p,)
    of: np.ndarray  # (p,) the particle
    along: np.ndarray  # (p,) m above the foot of the line
    aside: np.ndarray  # (p,) m

    def where(self, chosen: np.ndarray) -> _Beside:
        """Those pairs of which `chosen` is true."""
        return _Beside(*(values[chosen] for values in vars(self).values()))

    def filled(self, volume: np.ndarray, size: tuple[int, int], dp: float, dim: int) -> np.ndarray:
        """Share (k, m) of the space around points of k lines at m heights which pairs fill."""
        radius, step = REACH * dp, STEP * dp
        looks = int(2 * REACH / STEP) + 1
        found = np.zeros(size[0] * size[1])
        for part in _parts(len(self.line), MOST_LOOKS // looks):
            along = self.along[part, None]
            k = np.ceil((along - radius) / step).astype(int) + np.arange(looks)
            r = np.sqrt(self.aside[part, None] ** 2 + (along - step * k) ** 2)
            counts = (k >= 0) & (k < size[1]) & (r < radius)
            place = (self.line[part, None] * size[1] + k)[counts]
            share = kernel(r[counts], radius, dim)
            share *= np.broadcast_to(volume[part, None], r.shape)[counts]
            found += np.bincount(place, share, len(found))
        return found.reshape(size)


def _parts(n: int, most: int) -> Iterator[slice]:
    return (slice(start, start + most) for start in range(0, n, most))


def profiles(
    plan: np.ndarray, around: State, setting: Setting, up: np.ndarray, lowest: float
) -> Profiles:
    """Along each line of `plan` (k, dim) from `lowest` to above all that moves near it."""
    walls = around["motion"] == FIXED
    volume = around["mass"] / around["density"]
    radius, step = REACH * setting.dp, STEP * setting.dp
    flow = _beside(plan, around, ~walls, radius, up, lowest)
    top = np.zeros(len(plan))
    np.maximum.at(top, flow.line, flow.along)
    count = ((top + radius) / step).astype(int) + 2
    size = len(plan), int(count.max())
    height = step * np.arange(size[1])
    near = np.abs(around["position"] @ up - lowest - 0.5 * height[-1]) < 0.5 * height[-1] + radius
    solid = _beside(plan, around, walls & near, radius, up, lowest)
    wall = solid.filled(volume[solid.of], size, setting.dp, setting.dim)
    is_body = around["motion"][flow.of] == BOUND
    water, of_bodies = flow.where(~is_body), flow.where(is_body)
    filled, body = (
        part.filled(volume[part.of], size, setting.dp, setting.dim) for part in (water, of_bodies)
    )
    filled /= np.maximum(1.0 - wall - body, MIN_VOID)
    wall[np.arange(size[1]) >= count[:, None]] = 0.0  # above the flow nothing caps it
    return Profiles(lowest + height, filled, wall, body, _densities(water, around, size, setting))


def _beside(
    plan: np.ndarray, around: State, chosen: np.ndarray, radius: float, up: np.ndarray,
    lowest: float,
) -> _Beside:  # fmt: skip
    """The chosen particles with the lines of `plan` that are within `radius` of them."""
    from scipy.spatial import cKDTree

    of = np.flatnonzero(chosen)
    height = around["position"][of] @ up
    if not len(of):
        return _Beside(of, of, height, height)
    places = cKDTree(around["position"][of] - np.outer(height, up))
    pairs = cKDTree(plan).sparse_distance_matrix(places, radius, output_type="ndarray")
    return _Beside(pairs["i"], of[pairs["j"]], height[pairs["j"]] - lowest, pairs["v"])


def _densities(
    water: _Beside, around: State, size: tuple[int, int], setting: Setting
) -> np.ndarray:
    """Density (k, m) of the water on k lines, from below upwards, kg/m3.

    Each liquid has its mean along a line, so that one alone has the same everywhere; where there
    is none, the density goes from that below to that above.
    """
    mass, volume = around["mass"][water.of], around["mass"][water.of] / around["density"][water.of]
    kinds, kind = np.unique(around["material"][water.of], return_inverse=True)
    cell, cells = water.line * len(kinds) + kind, size[0] * len(kinds)
    space = np.bincount(cell, volume, cells).reshape(size[0], len(kinds))
    mean = np.bincount(cell, mass, cells).reshape(space.shape) / np.where(space > 0, space, 1.0)
    liquids = (space > 0).sum(axis=1)
    density = np.repeat(mean.max(axis=1, initial=0.0)[:, None], size[1], axis=1)
    mixed = water.where(liquids[water.line] > 1)
    if not len(mixed.line):
        return density
    volume, kind = volume[liquids[water.line] > 1], kind[liquids[water.line] > 1]
    filled, weight = (
        mixed.filled(v, size, setting.dp, setting.dim)
        for v in (volume, volume * mean[mixed.line, kind])
    )
    for k in np.flatnonzero((liquids > 1) & (filled > 0).any(axis=1)):
        some = np.flatnonzero(filled[k] > 0)
        density[k] = np.interp(np.arange(size[1]), some, weight[k, some] / filled[k, some])
    return density
