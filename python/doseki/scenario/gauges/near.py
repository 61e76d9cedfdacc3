"""The particles near a gauge, and what is interpolated from them."""

from __future__ import annotations

from itertools import product

import numpy as np

from ...record.particles import BOUND, FIXED
from .gauge import Sampled, Setting, State

REACH = 3.0  # spacings; radius of the interpolation
STEP = 0.5  # spacings; between two looks for the surface
MIN_VOID = 0.25  # share of a neighbourhood that walls and bodies leave; below, nothing is told
INSIDE = 0.5  # volume fraction from which on a point lies within the flow
ON_BED = 0.5  # spacings; a column that begins nearer to the surface of a wall begins there


def kernel(r: np.ndarray, radius: float, dim: int) -> np.ndarray:
    """Wendland's C6 kernel of support `radius`, m, at distances r, m; in 1/m^dim."""
    q = np.minimum(r / radius, 1.0)
    factor = 78 / (7 * np.pi) if dim == 2 else 1365 / (64 * np.pi)
    return factor / radius**dim * (1 - q) ** 8 * (1 + 8 * q + 25 * q**2 + 32 * q**3)


def particles_in(run: Sampled, setting: Setting, low: np.ndarray, high: np.ndarray) -> State:
    """Fields of the particles in a box, images across periodic axes included."""
    low, high = np.array(low), np.array(high)
    shifts: list[tuple[float, ...]] = [(0.0,)] * setting.dim
    for axis, first, last in setting.periods():
        length = last - first
        low[axis], high[axis] = max(low[axis], first - length), min(high[axis], last + length)
        shifts[axis] = (-length, 0.0, length)
    found = []
    for shift in product(*shifts):
        part = run.sample(list(low - shift), list(high - shift))
        if len(part["mass"]):
            found.append({**part, "position": part["position"] + shift})
    if not found:
        return run.sample(list(low), list(high))
    return {name: np.concatenate([part[name] for part in found]) for name in found[0]}


class Neighbourhood:
    """The particles around a gauge: those that count, walls, and bodies of other materials."""

    def __init__(self, setting: Setting, material: str | None, state: State) -> None:
        self.dim, self.radius = setting.dim, REACH * setting.dp
        walls = state["motion"] == FIXED
        counts = ~walls & setting.is_of_material(material, state)
        bodies = (state["motion"] == BOUND) & ~counts
        volume = state["mass"] / state["density"]
        self.position = state["position"][counts]
        self.velocity = state["velocity"][counts]
        # With which volume goes: schemes may shift particles beside their velocity.
        self.transport = (state["velocity"] + state.get("shift", 0.0))[counts]
        self.pressure = state["pressure"][counts]
        self.mass = state["mass"][counts]
        self.volume = volume[counts]
        self.wall_position, self.wall_volume = state["position"][walls], volume[walls]
        self.body_position, self.body_volume = state["position"][bodies], volume[bodies]

    def weights(self, x: np.ndarray, radius: float | None = None) -> np.ndarray:
        """Volume times kernel of each particle at a point."""
        return _weights(self.position, self.volume, x, radius or self.radius, self.dim)

    def fraction(self, x: np.ndarray) -> float:
        """Share of the space that walls and bodies leave around a point which particles fill."""
        walls = _weights(self.wall_position, self.wall_volume, x, self.radius, self.dim)
        bodies = _weights(self.body_position, self.body_volume, x, self.radius, self.dim)
        void = 1.0 - walls.sum() - bodies.sum()
        return float(self.weights(x).sum() / max(void, MIN_VOID))


def _weights(
    position: np.ndarray, volume: np.ndarray, x: np.ndarray, radius: float, dim: int
) -> np.ndarray:
    return volume * kernel(np.linalg.norm(position - x, axis=1), radius, dim)


class Column:
    """Particles near a line, in order along it, so that each look at it meets only a few."""

    def __init__(
        self, position: np.ndarray, volume: np.ndarray, foot: np.ndarray, up: np.ndarray
    ) -> None:
        """`up` is the unit vector of the line, which begins at `foot`."""
        away = position - foot
        along = away @ up
        order = np.argsort(along, kind="stable")
        self.along, self.volume = along[order], volume[order]
        self.aside = ((away - np.outer(along, up)) ** 2).sum(axis=1)[order]  # m2

    def filled(self, height: float, radius: float, dim: int) -> float:
        """Share of the space around the point at `height` along the line that they fill."""
        first, last = np.searchsorted(self.along, (height - radius, height + radius))
        r = np.sqrt(self.aside[first:last] + (self.along[first:last] - height) ** 2)
        return float(self.volume[first:last] @ kernel(r, radius, dim))


def column_height(around: Neighbourhood, foot: np.ndarray, up: np.ndarray, step: float) -> float:
    """Height, m, above `foot` at which the fraction first falls below one half, going up.

    Drops above a gap do not count; a gap right above the bed, where a flow hovers within the reach
    of the kernel, does not end the column.  `step` is the distance between looks, m; from one to
    the next, and within a body that leaves no room, the fraction is taken as linear.
    """
    radius, dim = around.radius, around.dim
    flow = Column(around.position, around.volume, foot, up)
    walls = Column(around.wall_position, around.wall_volume, foot, up)
    bodies = Column(around.body_position, around.body_volume, foot, up)
    top = max(float(column.along.max(initial=-np.inf)) for column in (flow, bodies)) + radius
    before, seen = 0.0, 0
    for k in range(int(top / step) + 2 if top > 0 else 0):
        taken = bodies.filled(k * step, radius, dim)
        void = 1.0 - walls.filled(k * step, radius, dim) - taken
        if taken > 0 and void < MIN_VOID:
            continue
        now = flow.filled(k * step, radius, dim) / max(void, MIN_VOID)
        if now < INSIDE <= before:
            return step * (seen + (k - seen) * (before - INSIDE) / (before - now))
        if now < INSIDE and k * step > radius:
            return 0.0
        before, seen = now, k
    return 0.0


def bed_height(around: Neighbourhood, foot: np.ndarray, up: np.ndarray, step: float) -> float:
    """Height, m, above `foot` of the surface of walls nearest to it on the line upwards.

    It is 0 where there is none, and where the foot stands on it within half a spacing, as far as
    particles tell.
    """
    radius, dim = around.radius, around.dim
    walls = Column(around.wall_position, around.wall_volume, foot, up)
    if not len(walls.along):
        return 0.0
    first, last = np.round((walls.along[[0, -1]] + [-radius, radius]) / step)
    heights = step * np.arange(first, last + 1)
    filled = np.array([walls.filled(height, radius, dim) for height in heights])
    ends = np.flatnonzero((filled[:-1] >= INSIDE) & (filled[1:] < INSIDE))
    if not len(ends):
        return 0.0
    surfaces = heights[ends] + step * (filled[ends] - INSIDE) / (filled[ends] - filled[ends + 1])
    nearest = float(surfaces[np.argmin(np.abs(surfaces))])
    return nearest if abs(nearest) > ON_BED * radius / REACH else 0.0


def tube(
    foot: np.ndarray, up: np.ndarray, length: float, radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Bounding box of what is within `radius` of a line from `foot`, m."""
    if np.isfinite(length):
        far = foot + length * up
    else:
        far = np.where(np.abs(up) > 1e-9, np.copysign(np.inf, up), foot)
    ends = np.array([foot, far])
    return ends.min(axis=0) - radius, ends.max(axis=0) + radius


def beside(state: State, foot: np.ndarray, up: np.ndarray, radius: float) -> State:
    """Those particles within `radius` of the line through `foot`."""
    away = state["position"] - foot
    away = away - np.outer(away @ up, up)
    near = (away**2).sum(axis=1) < radius**2
    return {name: values[near] for name, values in state.items()}
