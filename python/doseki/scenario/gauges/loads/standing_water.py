"""The water that stands against fixed bodies, and what it would press on them at rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ....record.particles import BOUND, FIXED
from ..gauge import Sampled, Setting, State
from ..near import INSIDE, MIN_VOID, REACH, Column, particles_in
from .outside_walls import clear_of_walls, left_by_walls
from .surface import Box, Elements, surface_of

OFF = 1.5  # spacings in front of the surface: where the water is looked at
STEP = 0.5  # spacings between two looks along a column
CELL = 1.0  # spacings; surface elements whose columns are this near share one
ASIDE = 0.27  # cells; keeps their edges off lattices, which rounding would put on either side
CAPPED = 0.75  # share of walls around a point from which on a column ends there
WITHIN = 0.5  # share of walls at their surface; beyond it no flow ends by itself
UNDER = 2  # looks below such a point, in which none does either


def standing_water(
    run: Sampled, setting: Setting, bodies: Sequence[str], about: np.ndarray, box: Box
) -> tuple[np.ndarray, np.ndarray]:
    """Force (dim,) and moment (1,) or (3,) about a point of water at rest, N, N m (Eq. 96).

    It stands in front of each piece of the surface as high as the flow does now, without a gap;
    its pressure is that of its depth.  The bodies lie within `box`.
    """
    g = float(np.linalg.norm(setting.gravity))
    elements = surface_of(run, setting, bodies, box)
    force = np.zeros_like(elements.place)
    if g > 0 and len(force):
        up = -setting.gravity / g
        around = _around(run, setting, elements, up)
        elements, probe = _outside_of_walls(elements, around, setting.dp)
        force = -g * _depths(elements, probe, around, setting, up)[:, None] * elements.area
    return force.sum(axis=0), moment_of(elements.place - about, force)


def moment_of(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Sum of the moments of forces (n, dim): (3,), or in 2-D (1,)."""
    if force.shape[1] == 2:
        return np.array([np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])])
    return np.asarray(np.cross(arm, force).sum(axis=0))


def _around(run: Sampled, setting: Setting, elements: Elements, up: np.ndarray) -> State:
    """All particles near the surface or above it."""
    reach = (OFF + REACH) * setting.dp
    low = np.where(up < -1e-9, -np.inf, elements.place.min(axis=0) - reach)
    high = np.where(up > 1e-9, np.inf, elements.place.max(axis=0) + reach)
    return particles_in(run, setting, low, high)


@dataclass(frozen=True)
class _Lines:
    """Vertical lines through the probes: where each stands in plan."""

    plan: np.ndarray  # (k, dim), m; normal to `up`
    of: np.ndarray  # (n,) the line of each element

    @classmethod
    def through(cls, probe: np.ndarray, up: np.ndarray, cell: float) -> _Lines:
        """One for the probes of each cell in plan; cells count from the probes themselves, so that
        it does not matter where the scene lies.
        """
        flat = probe - np.outer(probe @ up, up)
        cells = np.round((flat - flat.min(axis=0)) / cell + ASIDE)
        _, of = np.unique(cells, axis=0, return_inverse=True)
        of = of.reshape(-1)
        count = np.bincount(of)
        plan = np.stack([np.bincount(of, x) / count for x in flat.T], axis=1)
        return cls(plan, of)


def _depths(
    elements: Elements, probe: np.ndarray, around: State, setting: Setting, up: np.ndarray
) -> np.ndarray:
    """Density times depth (n,) of the water above each element, kg/m2.

    Points `probe` (n, dim) are in front of them.  Where a body hangs over one, the water is that of
    the nearest column that none caps.
    """
    n = len(elements.place)
    height, probed = elements.place @ up, probe @ up
    level, wet, weight = np.full(n, np.nan), np.zeros(n, bool), np.zeros(n)
    if not n:
        return weight
    lines = _Lines.through(probe, up, CELL * setting.dp)
    profiles = list(_profiles(lines.plan, around, setting, up, probed.min()))
    for k, profile in enumerate(profiles):
        mine = np.flatnonzero(lines.of == k)
        wet[mine] = profile.is_wet(probed[mine])
        level[mine] = np.where(wet[mine], profile.level(probed[mine]), np.nan)
    column = lines.of.copy()
    known = np.flatnonzero(np.isfinite(level))
    lost = np.flatnonzero(wet & np.isnan(level))
    if len(known) and len(lost):
        from scipy.spatial import cKDTree

        plan = lines.plan[lines.of]
        nearest = known[cKDTree(plan[known]).query(plan[lost])[1]]
        level[lost], column[lost] = level[nearest], column[nearest]
    below = level > height
    for k, profile in enumerate(profiles):
        mine = np.flatnonzero(below & (column == k))
        weight[mine] = profile.weight(height[mine], level[mine])
    return weight


def _outside_of_walls(elements: Elements, around: State, dp: float) -> tuple[Elements, np.ndarray]:
    """The parts of the pieces that no other wall covers, and points (n, dim) in front of them."""
    normal = elements.normal
    share, middle = left_by_walls(elements.parts, normal, elements.body, around, dp)
    some = share > 0
    body, area = elements.body[some], share[some, None] * elements.area[some]
    left = Elements(middle[some], area, elements.parts[some], body)
    probe = left.place + OFF * dp * normal[some]
    return left, clear_of_walls(probe, body, around, dp)


@dataclass(frozen=True)
class _Profile:
    """What is along one line: shares of the space at heights, from below upwards."""

    height: np.ndarray  # (m,) m
    filled: np.ndarray  # (m,) by what moves, of the space that walls leave
    wall: np.ndarray  # (m,)
    density: np.ndarray  # (m,) of the water there, kg/m3

    def weight(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Integral (n,) of the density between heights, kg/m2; beyond the ends it stays."""
        mean, x = 0.5 * (self.density[1:] + self.density[:-1]), self.height
        sums = np.append(0.0, np.cumsum(mean * np.diff(x)))
        below, above = (
            self.density[0] * np.minimum(0.0, end - x[0])
            + np.interp(end, x, sums)
            + self.density[-1] * np.maximum(0.0, end - x[-1])
            for end in (low, high)
        )
        return np.asarray(above - below)

    def is_wet(self, height: np.ndarray) -> np.ndarray:
        """Whether there is a flow at heights (n,)."""
        return np.interp(height, self.height, self.filled, right=0.0) >= INSIDE

    def level(self, height: np.ndarray) -> np.ndarray:
        """Where the flow that is at heights (n,) ends above them; nan below something that caps."""
        gone, capped = self.filled < INSIDE, self.wall > CAPPED
        capped |= gone & (self.wall > WITHIN)
        for above in range(1, UNDER + 1):  # flows end before walls do
            capped[:-above] |= gone[:-above] & (self.wall[above:] > CAPPED)
        ends = np.flatnonzero(gone | capped)
        found = np.searchsorted(self.height[ends], height, side="right")
        levels = np.full(len(height), np.nan)
        for k, first in enumerate(found):
            if first < len(ends) and not capped[ends[first]]:
                levels[k] = max(height[k], self._crossing(int(ends[first])))
        return levels

    def _crossing(self, k: int) -> float:
        if k == 0:
            return float(self.height[0])
        before, now = self.filled[k - 1], self.filled[k]
        share = (before - INSIDE) / (before - now) if before > INSIDE else 0.0
        return float(self.height[k - 1] + share * (self.height[k] - self.height[k - 1]))


def _profiles(
    plan: np.ndarray, around: State, setting: Setting, up: np.ndarray, lowest: float
) -> Iterator[_Profile]:
    """Along each line of `plan` from `lowest` to above all that moves near it."""
    from scipy.spatial import cKDTree

    walls = around["motion"] == FIXED
    water = ~walls & (around["motion"] != BOUND)
    position, volume = around["position"], around["mass"] / around["density"]
    tree = cKDTree(position - np.outer(position @ up, up))
    radius, step = REACH * setting.dp, STEP * setting.dp
    for foot in plan:
        near = np.sort(np.array(tree.query_ball_point(foot, radius), dtype=np.int64))
        start = foot + lowest * up
        wet, rigid = near[~walls[near]], near[walls[near]]
        flow = Column(position[wet], volume[wet], start, up)
        solid = Column(position[rigid], volume[rigid], start, up)
        top = float(flow.along.max(initial=0.0)) + radius
        height = step * np.arange(int(top / step) + 2)
        wall = np.array([solid.filled(s, radius, setting.dim) for s in height])
        filled = np.array([flow.filled(s, radius, setting.dim) for s in height])
        of_water = {name: values[near[water[near]]] for name, values in around.items()}
        density = _densities(of_water, start + height[:, None] * up, up, setting)
        yield _Profile(lowest + height, filled / np.maximum(1.0 - wall, MIN_VOID), wall, density)


def _densities(water: State, x: np.ndarray, up: np.ndarray, setting: Setting) -> np.ndarray:
    """Density (m,) of the water at places (m, dim) from below upwards along a line, kg/m3.

    Each liquid has its mean along the line, so that one alone has the same everywhere; where there
    is none, the density goes from that below to that above.
    """
    if not len(water["mass"]):
        return np.zeros(len(x))
    volume = water["mass"] / water["density"]
    _, of = np.unique(water["material"], return_inverse=True)
    mean = np.bincount(of, water["mass"]) / np.bincount(of, volume)
    if len(mean) == 1:
        return np.full(len(x), mean[0])
    height, radius = (x - x[0]) @ up, REACH * setting.dp
    space, mass = (
        np.array([column.filled(s, radius, setting.dim) for s in height])
        for column in (Column(water["position"], v, x[0], up) for v in (volume, volume * mean[of]))
    )
    some = space > 0
    return np.interp(height, height[some], mass[some] / space[some])
