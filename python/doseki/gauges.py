"""Gauges: what instruments in the flow would read, from the particles near them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from .gauge_tables import gauge_columns, gauge_interval
from .inflows import section_axes
from .particles import FIXED
from .scenario import Scenario
from .schema import (
    Discharge,
    FlowGauge,
    ForceGauge,
    Gauge,
    PressureGauge,
    SurfaceHeight,
    VelocityProfile,
)

REACH = 3.0  # spacings; radius of the interpolation
SLAB = 4.0  # spacings; length of the slab of a discharge gauge
STEP = 0.5  # spacings; between two looks for the surface
LEAST_VOID = 0.25  # share of a neighbourhood that walls leave; below, nothing is told from it
INSIDE = 0.5  # volume fraction from which on a point lies within the flow

State = Mapping[str, np.ndarray]
Rows = list[list[float]]


@dataclass(frozen=True)
class GaugeReader:
    """One gauge of a scenario, to be read from a core simulation."""

    name: str
    columns: dict[str, str]  # name and unit
    interval: float  # s
    read: Callable[[Any], Rows]

    @property
    def header(self) -> list[str]:
        """The first line of its file."""
        return [f"{name} [{unit}]" for name, unit in self.columns.items()]


def build_gauges(scenario: Scenario, body_names: list[str]) -> list[GaugeReader]:
    """A reader for every gauge of the scenario."""
    return [
        GaugeReader(
            name,
            gauge_columns(gauge, scenario.dim),
            gauge_interval(scenario, gauge),
            partial(READERS[type(gauge)], scenario, gauge, body_names),
        )
        for name, gauge in scenario.gauge.items()
    ]


def kernel(r: np.ndarray, radius: float, dim: int) -> np.ndarray:
    """Wendland's C6 kernel of support `radius`, m, at distances r, m; in 1/m^dim."""
    q = np.minimum(r / radius, 1.0)
    factor = 78 / (7 * np.pi) if dim == 2 else 1365 / (64 * np.pi)
    return factor / radius**dim * (1 - q) ** 8 * (1 + 8 * q + 25 * q**2 + 32 * q**3)


def upwards(scenario: Scenario, direction: np.ndarray | None) -> np.ndarray:
    """Unit vector of `direction`; without one against gravity, without gravity the last axis."""
    for wish in (direction, -scenario.gravity, np.eye(scenario.dim)[-1]):
        if wish is not None and np.any(wish):
            return wish / np.linalg.norm(wish)
    raise AssertionError("the last axis is not zero")


def particles_in(scenario: Scenario, simulation: Any, low: np.ndarray, high: np.ndarray) -> State:
    """Fields of the particles in a box, images across periodic axes included."""
    low, high = np.array(low), np.array(high)
    shifts = [(0.0,)] * scenario.dim
    for axis in ("xyz".index(name) for name in scenario.periodic):
        length = scenario.domain_max[axis] - scenario.domain_min[axis]
        low[axis] = max(low[axis], scenario.domain_min[axis] - length)
        high[axis] = min(high[axis], scenario.domain_max[axis] + length)
        shifts[axis] = (-length, 0.0, length)
    found = []
    for shift in product(*shifts):
        part = simulation.sample(list(low - shift), list(high - shift))
        if len(part["mass"]):
            found.append(part | {"position": part["position"] + shift})
    if not found:
        return simulation.sample(list(low), list(high))
    return {name: np.concatenate([part[name] for part in found]) for name in found[0]}


class Neighbourhood:
    """The particles around a gauge: those that count, and walls."""

    def __init__(self, scenario: Scenario, material: str | None, state: State) -> None:
        self.dim, self.radius = scenario.dim, REACH * scenario.dp
        walls = state["motion"] == FIXED
        counts = ~walls
        if material is not None:
            names = scenario.material_names
            number = names.index(material) if material in names else -1
            counts &= state["material"] == number
        self.position = state["position"][counts]
        self.velocity = state["velocity"][counts]
        self.pressure = state["pressure"][counts]
        self.mass = state["mass"][counts]
        self.volume = self.mass / state["density"][counts]
        self.wall_position = state["position"][walls]
        self.wall_volume = (state["mass"] / state["density"])[walls]

    def weights(self, x: np.ndarray, radius: float | None = None) -> np.ndarray:
        """Volume times kernel of each particle at a point."""
        return _weights(self.position, self.volume, x, radius or self.radius, self.dim)

    def fraction(self, x: np.ndarray) -> float:
        """Share of the space that walls leave around a point which the particles fill."""
        walls = _weights(self.wall_position, self.wall_volume, x, self.radius, self.dim)
        return float(self.weights(x).sum() / max(1.0 - walls.sum(), LEAST_VOID))


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
    of the kernel, does not end the column.  `step` is the distance between looks, m; within a step
    the fraction is taken as linear.
    """
    radius, dim = around.radius, around.dim
    flow = Column(around.position, around.volume, foot, up)
    walls = Column(around.wall_position, around.wall_volume, foot, up)
    top, before = float(flow.along.max(initial=-np.inf)) + radius, 0.0
    for k in range(int(top / step) + 2 if top > 0 else 0):
        void = max(1.0 - walls.filled(k * step, radius, dim), LEAST_VOID)
        now = flow.filled(k * step, radius, dim) / void
        if now < INSIDE <= before:
            return step * (k - 1 + (before - INSIDE) / (before - now))
        if now < INSIDE and k * step > radius:
            return 0.0
        before = now
    return 0.0


def _tube(foot: np.ndarray, up: np.ndarray, length: float, radius: float) -> tuple[Any, Any]:
    """Bounding box of what is within `radius` of a line from `foot`, m."""
    if np.isfinite(length):
        far = foot + length * up
    else:
        far = np.where(np.abs(up) > 1e-9, np.copysign(np.inf, up), foot)
    ends = np.array([foot, far])
    return ends.min(axis=0) - radius, ends.max(axis=0) + radius


def _beside(state: State, foot: np.ndarray, up: np.ndarray, radius: float) -> State:
    """Those particles within `radius` of the line through `foot`."""
    away = state["position"] - foot
    away = away - np.outer(away @ up, up)
    near = (away**2).sum(axis=1) < radius**2
    return {name: values[near] for name, values in state.items()}


def _read_height(scenario: Scenario, gauge: SurfaceHeight, _names: list[str], sim: Any) -> Rows:
    up, reach = upwards(scenario, gauge.direction), REACH * scenario.dp
    state = particles_in(scenario, sim, *_tube(gauge.position, up, np.inf, reach))
    around = Neighbourhood(scenario, gauge.material, _beside(state, gauge.position, up, reach))
    return [[sim.time, column_height(around, gauge.position, up, STEP * scenario.dp)]]


def _read_profile(scenario: Scenario, gauge: VelocityProfile, _names: list[str], sim: Any) -> Rows:
    up, reach = upwards(scenario, gauge.direction), REACH * scenario.dp
    state = particles_in(scenario, sim, *_tube(gauge.position, up, gauge.length, reach))
    around = Neighbourhood(scenario, gauge.material, state)
    rows = []
    for height in (np.arange(gauge.count) + 0.5) * gauge.length / gauge.count:
        x = gauge.position + height * up
        fraction, velocity = around.fraction(x), np.full(scenario.dim, np.nan)
        if fraction >= INSIDE:
            weights = around.weights(x)
            velocity = weights @ around.velocity / weights.sum()
        rows.append([sim.time, height, *velocity, fraction])
    return rows


def _read_pressure(scenario: Scenario, gauge: PressureGauge, _names: list[str], sim: Any) -> Rows:
    radius = gauge.radius or REACH * scenario.dp
    state = particles_in(scenario, sim, gauge.position - radius, gauge.position + radius)
    around = Neighbourhood(scenario, gauge.material, state)
    weights = around.weights(gauge.position, radius)
    total = weights.sum()
    return [[sim.time, weights @ around.pressure / total if total > 0 else 0.0]]


def _read_discharge(scenario: Scenario, gauge: Discharge, _names: list[str], sim: Any) -> Rows:
    normal = gauge.direction / np.linalg.norm(gauge.direction)
    length = gauge.length or SLAB * scenario.dp
    up, across = section_axes(normal, scenario.gravity)
    # Only a normal along an axis bounds the box; what lies beyond the slab is cut off below.
    bounded = np.abs(normal) > 1 - 1e-9
    low = np.where(bounded, gauge.position - length, -np.inf)
    high = np.where(bounded, gauge.position + length, np.inf)
    state = particles_in(scenario, sim, low, high)
    around = Neighbourhood(scenario, gauge.material, state)
    away = around.position - gauge.position
    # A hat rather than a box: no particle comes in or goes out with a jump.
    share = np.maximum(0.0, 1 - np.abs(away @ normal) / (0.5 * length)) / (0.5 * length)
    for axis, extent in ((up, gauge.depth), (across, gauge.width)):
        if axis is not None and extent is not None:
            share *= (away @ axis >= 0) & (away @ axis <= extent)
    speed = share * (around.velocity @ normal)
    return [[sim.time, around.volume @ speed, around.mass @ speed]]


def _read_force(scenario: Scenario, gauge: ForceGauge, names: list[str], sim: Any) -> Rows:
    state = sim.state()
    of_them = np.isin(state["body"], [names.index(name) for name in gauge.bodies])
    force = state["force"][of_them & (state["motion"] == FIXED)]
    position = state["position"][of_them & (state["motion"] == FIXED)]
    about = np.zeros(scenario.dim) if gauge.about is None else gauge.about
    total, moment = force_and_moment(position, force, about)
    return [[sim.time, *total, *moment]]


def force_and_moment(
    position: np.ndarray, force: np.ndarray, about: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sum of forces (N, dim) and of their moments about a point; the moment is (1,) in 2-D."""
    arm = position - about
    if len(about) == 2:
        return force.sum(axis=0), np.array(
            [np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])]
        )
    return force.sum(axis=0), np.cross(arm, force).sum(axis=0)


def outside_everything(scenario: Scenario, state: State) -> list[str]:
    """Names of gauges that lie outside the box around all particles and inflow sections."""
    points = [state["position"], *(inflow.position[None, :] for inflow in scenario.inflow.values())]
    everything = np.concatenate(points)
    low, high = everything.min(axis=0) - scenario.dp, everything.max(axis=0) + scenario.dp
    return [
        name
        for name, gauge in scenario.gauge.items()
        if isinstance(gauge, FlowGauge)
        and (np.any(gauge.position < low) or np.any(gauge.position > high))
    ]


READERS: dict[type[Gauge], Callable[..., Rows]] = {
    SurfaceHeight: _read_height,
    VelocityProfile: _read_profile,
    PressureGauge: _read_pressure,
    Discharge: _read_discharge,
    ForceGauge: _read_force,
}
