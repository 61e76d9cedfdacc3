"""The water that stands against fixed bodies, and what it would press on them at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ....record.particles import FIXED
from ..gauge import Sampled, Setting, State
from ..near import REACH, particles_in
from .outside_walls import CLEAR, DEEPEST, WALL, clear_of_walls, left_by_walls
from .profiles import STEP, Profiles, profiles
from .surface import Box, Elements, surface_of

OFF = 1.5  # spacings in front of the surface: where the water is looked at
CELL = 1.0  # spacings; surface elements whose columns are this near share one
ASIDE = 0.27  # cells; keeps their edges off lattices, which rounding would put on either side
FAR = OFF + CLEAR + DEEPEST + CELL + REACH + STEP  # spacings; what is farther off changes nothing


def standing_water(
    run: Sampled,
    setting: Setting,
    bodies: Sequence[str],
    about: np.ndarray,
    box: Box,
    known: Known | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Force (dim,) and moment (1,) or (3,) about a point of water at rest, N, N m (Eq. 96).

    It stands in front of each piece of the surface as high as the water does now, without a gap;
    its pressure is that of its depth.  The bodies lie within `box`; `known` is what was found out
    about bodies that stand still.
    """
    dim, g = setting.dim, float(np.linalg.norm(setting.gravity))
    nothing = np.zeros(dim), np.zeros(1 if dim == 2 else 3)
    if g == 0.0 or not _is_anything_near(run, setting, box):
        return nothing
    known, up = known or Known(), -setting.gravity / g
    around = None if known.surface is None else _around(run, setting, known.surface, up)
    if around is None or not known.is_of(around):
        surface = surface_of(run, setting, bodies, box)
        if not len(surface.place):
            return nothing
        around = _around(run, setting, surface, up)
        known.learn(surface, around, setting.dp, up)
    assert known.outside is not None
    elements = known.outside.elements
    force = -g * _depths(known.outside, around, setting, up)[:, None] * elements.area
    return force.sum(axis=0), moment_of(elements.place - about, force)


def moment_of(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Sum of the moments of forces (n, dim): (3,), or in 2-D (1,)."""
    if force.shape[1] == 2:
        return np.array([np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])])
    return np.asarray(np.cross(arm, force).sum(axis=0))


def _is_anything_near(run: Sampled, setting: Setting, box: Box) -> bool:
    """Whether anything that moves is so near to a box that it could press on a body there."""
    reach = FAR * setting.dp
    near = particles_in(run, setting, box[0] - reach, box[1] + reach)
    return bool((near["motion"] != FIXED).any())


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


@dataclass(frozen=True)
class _Outside:
    """The parts of a surface that no other wall covers."""

    elements: Elements
    probe: np.ndarray  # (n, dim) points in front of them, m
    lines: _Lines  # through these


@dataclass
class Known:
    """What walls alone decide about bodies that stand still: it is worked out once, and anew where
    walls near them have changed, as those that come with a flow over a terrain.
    """

    surface: Elements | None = None
    outside: _Outside | None = None
    _walls: dict[str, np.ndarray] = field(default_factory=dict)

    def is_of(self, around: State) -> bool:
        """Whether it was learnt from the walls that are around the bodies now."""
        now = _walls_of(around)
        return all(np.array_equal(values, self._walls[key]) for key, values in now.items())

    def learn(self, surface: Elements, around: State, dp: float, up: np.ndarray) -> None:
        """Take in a surface and the particles around it."""
        self.surface, self._walls = surface, _walls_of(around)
        elements, probe = _outside_of_walls(surface, around, dp)
        self.outside = _Outside(elements, probe, _Lines.through(probe, up, CELL * dp))


def _walls_of(around: State) -> dict[str, np.ndarray]:
    """What is asked about walls, of those in `around`."""
    fixed = around["motion"] == FIXED
    return {key: around[key][fixed] for key in (*WALL, "body")}


def _depths(outside: _Outside, around: State, setting: Setting, up: np.ndarray) -> np.ndarray:
    """Density times depth (n,) of the water above each element, kg/m2.

    Where a body hangs over the point in front of one, the water is that of the nearest column that
    none caps.
    """
    place, probe, lines = outside.elements.place, outside.probe, outside.lines
    weight = np.zeros(len(place))
    if not len(weight):
        return weight
    some, of = _lines_in_flow(lines, probe @ up, around, setting, up)
    if not len(some):
        return weight
    along = profiles(lines.plan[of], around, setting, up, (probe @ up).min())
    number = np.searchsorted(of, lines.of[some])
    weight[some] = _weights(
        along, number, lines.plan[lines.of[some]], (place @ up)[some], (probe @ up)[some]
    )
    return weight


def _lines_in_flow(
    lines: _Lines, probed: np.ndarray, around: State, setting: Setting, up: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Which probes have a line that anything that moves is near at their height, and these lines.

    The others are dry.
    """
    from scipy.spatial import cKDTree

    moving = around["position"][around["motion"] != FIXED]
    if not len(moving):
        return np.array([], int), np.array([], int)
    point = lines.plan[lines.of] + np.outer(probed, up)
    reach = (REACH + STEP) * setting.dp * (1 + 1e-6)
    low, high = moving.min(axis=0) - reach, moving.max(axis=0) + reach
    some = np.flatnonzero(((point > low) & (point < high)).all(axis=1))
    near = np.isfinite(cKDTree(moving).query(point[some], distance_upper_bound=reach)[0])
    return some[near], np.unique(lines.of[some[near]])


def _weights(
    along: Profiles, line: np.ndarray, plan: np.ndarray, height: np.ndarray, probed: np.ndarray
) -> np.ndarray:
    """Density times depth (n,) above heights of elements, whose probes are on lines, kg/m2."""
    in_body = along.is_in_body(line, probed)
    wet = along.is_wet(line, probed) & ~in_body
    level = np.where(wet, along.level(line, probed), np.nan)
    known, lost = np.isfinite(level), wet & np.isnan(level)
    dry = ~np.isin(line, line[wet | in_body])
    level[dry] = -np.inf
    line = line.copy()
    _take_nearest(level, line, plan, lost, known)
    _take_nearest(level, line, plan, in_body, known | dry)
    below = level > height
    weight = np.zeros(len(height))
    weight[below] = along.weight(line[below], height[below], level[below])
    return weight


def _take_nearest(
    level: np.ndarray, line: np.ndarray, plan: np.ndarray, which: np.ndarray, known: np.ndarray
) -> None:
    """Give these elements the level and the line of the nearest one of which that is known."""
    from scipy.spatial import cKDTree

    of, lost = np.flatnonzero(known), np.flatnonzero(which)
    if len(of) and len(lost):
        nearest = of[cKDTree(plan[of]).query(plan[lost])[1]]
        level[lost], line[lost] = level[nearest], line[nearest]


def _outside_of_walls(elements: Elements, around: State, dp: float) -> tuple[Elements, np.ndarray]:
    """The parts of the pieces that no other wall covers, and points (n, dim) in front of them."""
    normal = elements.normal
    share, middle = left_by_walls(elements.parts, normal, elements.body, around, dp)
    some = share > 0
    body, area = elements.body[some], share[some, None] * elements.area[some]
    left = Elements(middle[some], area, elements.parts[some], body)
    probe = left.place + OFF * dp * normal[some]
    return left, clear_of_walls(probe, body, around, dp)
