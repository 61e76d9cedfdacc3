"""The water that stands against fixed bodies, and what it would press on them at rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ....record.particles import BOUND, FIXED
from ..gauge import Sampled, Setting, State
from ..near import INSIDE, MIN_VOID, REACH, Column, particles_in
from .outside_walls import clear_of_walls, left_by_walls

OFF = 1.5  # spacings in front of the surface: where the water is looked at
STEP = 0.5  # spacings between two looks along a column
CELL = 1.0  # spacings; surface elements whose columns are this near share one
ASIDE = 0.27  # cells; keeps their edges off lattices, which rounding would put on either side
CAPPED = 0.75  # share of walls around a point from which on a column ends there
EDGE_REACH, LIKE, UNLIKE, EVEN = 1.5, 0.9, 0.5, 0.3  # neighbours and their normals at an edge


@dataclass(frozen=True)
class Elements:
    """Pieces of the surface of the bodies: n wall particles of the first row."""

    place: np.ndarray  # (n, dim) on the surface, m
    area: np.ndarray  # (n, dim) outwards, m2; 2-D: m
    probe: np.ndarray  # (n, dim) in front of it, m
    body: np.ndarray  # (n,) which it is of


Box = tuple[np.ndarray, np.ndarray]  # lower and upper corner, m


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
        elements = _outside_of_walls(elements, around, setting.dp)
        force = -g * _depths(elements, around, setting, up)[:, None] * elements.area
    return force.sum(axis=0), moment_of(elements.place - about, force)


def moment_of(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Sum of the moments of forces (n, dim): (3,), or in 2-D (1,)."""
    if force.shape[1] == 2:
        return np.array([np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])])
    return np.asarray(np.cross(arm, force).sum(axis=0))


def surface_of(run: Sampled, setting: Setting, bodies: Sequence[str], box: Box) -> Elements:
    """The surface of the fixed bodies of some tables, which lie within a box."""
    state = run.sample(list(box[0]), list(box[1]))
    mine = _first_row(state, setting, bodies)
    normal, position, depth = (state[key][mine] for key in ("normal", "position", "depth"))
    place = position + depth[:, None] * normal
    size = state["mass"][mine] / state["density"][mine] / setting.dp
    size *= _faces(position, normal, depth, setting.dp)
    probe = place + OFF * setting.dp * normal
    return Elements(place, size[:, None] * normal, probe, state["body"][mine])


def _around(run: Sampled, setting: Setting, elements: Elements, up: np.ndarray) -> State:
    """All particles near the surface or above it."""
    reach = (OFF + REACH) * setting.dp
    low = np.where(up < -1e-9, -np.inf, elements.place.min(axis=0) - reach)
    high = np.where(up > 1e-9, np.inf, elements.place.max(axis=0) + reach)
    return particles_in(run, setting, low, high)


def _first_row(state: State, setting: Setting, bodies: Sequence[str]) -> np.ndarray:
    facing = np.linalg.norm(state["normal"], axis=1) > 0.5
    fixed = (state["motion"] == FIXED) & setting.is_of_bodies(bodies, state)
    return np.flatnonzero(fixed & facing & (state["depth"] < setting.dp))


def _faces(position: np.ndarray, normal: np.ndarray, depth: np.ndarray, dp: float) -> np.ndarray:
    """Area (n,) of the surface over each particle, over that of a plane through it.

    An edge has neighbours of other normals on both sides, whose mean is its own: where m faces
    meet at right angles it has sqrt(m) of the area.  On a curved surface normals spread.
    """
    from scipy.spatial import cKDTree

    i, j = cKDTree(position).query_pairs(EDGE_REACH * dp, output_type="ndarray").T
    i, j = np.concatenate([i, j]), np.concatenate([j, i])
    alike = np.einsum("ij,ij->i", normal[i], normal[j])
    smooth = alike > LIKE
    spread = _spread(position, normal, i[smooth], j[smooth])
    curved = np.maximum(0.0, 1 + depth * spread) ** (position.shape[1] - 1)
    other = (alike > UNLIKE + 1e-6) & ~smooth
    i, j, alike = i[other], j[other], alike[other]
    n = len(position)
    count, least = np.bincount(i, minlength=n), np.ones(n)
    np.minimum.at(least, i, alike)
    aside = np.zeros_like(position)
    np.add.at(aside, i, normal[j] - alike[:, None] * normal[i])
    even = np.linalg.norm(aside, axis=1) < EVEN * np.maximum(count, 1)
    edges = np.round(1 / least**2) * least
    return np.where((count > 1) & even, edges, curved)


def _spread(position: np.ndarray, normal: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Mean curvature (n,), 1/m, from neighbours; of a ball 1 over the radius of the row."""
    apart = position[j] - position[i]
    turned = np.einsum("ij,ij->i", normal[j] - normal[i], apart)
    rate = turned / np.einsum("ij,ij->i", apart, apart)
    n = len(position)
    return np.bincount(i, rate, n) / np.maximum(np.bincount(i, minlength=n), 1)


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


def _depths(elements: Elements, around: State, setting: Setting, up: np.ndarray) -> np.ndarray:
    """Density times depth (n,) of the water above each element, kg/m2.

    Where a body hangs over it, the level is that of the nearest column that none caps.
    """
    n = len(elements.place)
    height, probed = elements.place @ up, elements.probe @ up
    level, density, wet = np.full(n, np.nan), np.zeros(n), np.zeros(n, bool)
    if not n:
        return level
    lines = _Lines.through(elements.probe, up, CELL * setting.dp)
    for k, profile in enumerate(_profiles(lines.plan, around, setting, up, probed.min())):
        mine = np.flatnonzero(lines.of == k)
        wet[mine] = profile.is_wet(probed[mine])
        level[mine] = np.where(wet[mine], profile.level(probed[mine]), np.nan)
        density[mine] = profile.density
    known = np.flatnonzero(np.isfinite(level))
    lost = np.flatnonzero(wet & np.isnan(level))
    if len(known) and len(lost):
        from scipy.spatial import cKDTree

        plan = lines.plan[lines.of]
        nearest = known[cKDTree(plan[known]).query(plan[lost])[1]]
        level[lost], density[lost] = level[nearest], density[nearest]
    depth = np.where(np.isfinite(level), level - height, 0.0)
    return density * np.maximum(0.0, depth)


def _outside_of_walls(elements: Elements, around: State, dp: float) -> Elements:
    """The parts of the pieces that no other wall covers."""
    size = np.linalg.norm(elements.area, axis=1)
    normal = elements.area / np.maximum(size, 1e-300)[:, None]
    share, middle = left_by_walls(elements.place, normal, elements.body, around, dp)
    some, moved = share > 0, middle - elements.place
    body, probe = elements.body[some], (elements.probe + moved)[some]
    probe = clear_of_walls(probe, body, around, dp)
    return Elements(middle[some], (share[:, None] * elements.area)[some], probe, body)


@dataclass(frozen=True)
class _Profile:
    """What is along one line: shares of the space at heights, from below upwards."""

    height: np.ndarray  # (m,) m
    filled: np.ndarray  # (m,) by what moves, of the space that walls leave
    wall: np.ndarray  # (m,)
    density: float  # of the water, kg/m3

    def is_wet(self, height: np.ndarray) -> np.ndarray:
        """Whether there is a flow at heights (n,)."""
        return np.interp(height, self.height, self.filled, right=0.0) >= INSIDE

    def level(self, height: np.ndarray) -> np.ndarray:
        """Where the flow that is at heights (n,) ends above them; nan below something that caps."""
        gone, capped = self.filled < INSIDE, self.wall > CAPPED
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
        of_water = near[water[near]]
        mass = float(around["mass"][of_water].sum())
        density = mass / float(volume[of_water].sum()) if len(of_water) else 0.0
        yield _Profile(lowest + height, filled / np.maximum(1.0 - wall, MIN_VOID), wall, density)
