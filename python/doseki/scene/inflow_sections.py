"""Inflow sections: where particles enter, how fast, and in which pattern."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..record.particles import FIXED, ParticleSet, check_size
from ..scenario.model import Scenario
from ..scenario.values.directions import section_axes
from .ground import ground_of
from .lattices import ROUNDING

INSTANTS = 2000  # at which the volume of a surge is looked at
NEAREST = 0.4  # spacings between an inflow and a terrain


@dataclass(frozen=True)
class InflowSection:
    """A plane section through which layers of particles enter, SI units.

    `rows` are the particles of one layer as they cross the section.  Behind it `buffer_layers`
    more layers, `spacing` apart, move with the same speed, so that what has entered always has
    neighbours upstream.  `speeds` hold at `times` and are linear in between; `distances` is how far
    layers have gone by then.
    """

    name: str
    material: int  # index into scenario.material_names
    body: int  # index into the body names
    rows: np.ndarray  # (n, dim)
    direction: np.ndarray  # (dim,), unit vector of the flow
    times: np.ndarray  # (k,)
    speeds: np.ndarray  # (k,)
    distances: np.ndarray  # (k,)
    spacing: float
    mass: float  # of each particle, kg (2-D: kg/m)
    density: float
    smoothing_length: float
    buffer_layers: int
    jitter: float  # random displacement of a particle, in spacings
    thickness: np.ndarray  # (k,) at `times`, m; none: every layer is whole
    row_height: np.ndarray  # (n,) above the bed, m, where there is a thickness

    @property
    def start(self) -> float:
        """When the first layer sets out, s."""
        return float(self.times[0])

    @property
    def stop(self) -> float:
        """When the last layer has entered, s."""
        return float(self.times[-1])

    @property
    def speed(self) -> float:
        """Largest speed, m/s."""
        return float(self.speeds.max())

    @property
    def rate_mass(self) -> float:
        """Largest mass that enters in a second, kg/s (2-D: kg/s/m)."""
        return self.mass * len(self.rows) * self.speed / self.spacing

    def entered(self, time: np.ndarray) -> np.ndarray:
        """Particles that have entered by each time, s, a fraction of a layer included."""
        t = np.clip(time, self.start, self.stop)
        k = np.clip(np.searchsorted(self.times, t, "right") - 1, 0, len(self.times) - 2)
        since, speed = t - self.times[k], np.interp(t, self.times, self.speeds)
        gone = self.distances[k] + 0.5 * (self.speeds[k] + speed) * since
        return gone / self.spacing * len(self.rows)


def build_inflows(
    scenario: Scenario, body_names: list[str], particles: ParticleSet | None = None
) -> list[InflowSection]:
    """The inflow sections; `body_names` are those of `build_bodies`.

    Raises UserError, also where a section lies inside a wall of the `particles` given.
    """
    sections = [_section(scenario, name, body_names.index(name)) for name in scenario.inflow]
    if particles is not None:
        for section in sections:
            _check_outside_walls(scenario, section, particles, body_names)
    return sections


def _section(scenario: Scenario, name: str, body: int) -> InflowSection:
    inflow, dp, dim = scenario.inflow[name], scenario.dp, scenario.dim
    material = scenario.materials[inflow.material]
    direction = inflow.direction / np.linalg.norm(inflow.direction)
    rows = rows_of(scenario, name)
    rows = rows[above_ground(scenario, rows, direction)]
    if not len(rows):
        raise scenario.where.error(
            ("inflow", name, "position"), f"inflow.{name}: all of its section lies in the ground"
        )
    times, rate = inflow.rows.T
    area = len(rows) * dp ** (dim - 1) * (inflow.width if dim == 2 else 1.0)
    speeds, thickness, heights = rate / area, np.zeros(0), np.zeros(0)
    if inflow.surge is not None:
        _, thickness, speeds = np.array(inflow.surge, dtype=float).T
        heights = _heights(scenario, name, rows)
    steps = 0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times)
    return InflowSection(
        name=name,
        material=scenario.material_names.index(inflow.material),
        body=body,
        rows=rows,
        direction=direction,
        times=times,
        speeds=speeds,
        distances=np.concatenate([[0.0], np.cumsum(steps)]),
        spacing=dp,
        mass=material.rho0 * dp**dim,
        density=material.rho0,
        smoothing_length=scenario.eta * dp,
        buffer_layers=_buffer_layers(scenario),
        jitter=inflow.jitter,
        thickness=thickness,
        row_height=heights,
    )


def _heights(scenario: Scenario, name: str, rows: np.ndarray) -> np.ndarray:
    """Heights (N,) of the points of a layer above the lowest point of the bed in the section, m."""
    inflow = scenario.inflow[name]
    direction = inflow.direction / np.linalg.norm(inflow.direction)
    up, _ = section_axes(direction, scenario.gravity)
    return np.asarray((rows - inflow.position) @ up) - _lowest_bed(scenario, name)


def _lowest_bed(scenario: Scenario, name: str) -> float:
    """How far the bed of a terrain lies above the foot of the section of a surge at least, m."""
    if scenario.bed is None or scenario.inflow[name].surge is None:
        return 0.0
    return max(0.0, float(_bed_across(scenario, name).min()))


def _bed_across(scenario: Scenario, name: str) -> np.ndarray:
    """Heights (n,) of the bed of a terrain above the foot of a section, evenly across it, m."""
    inflow, bed = scenario.inflow[name], scenario.bed
    assert bed is not None
    direction = inflow.direction / np.linalg.norm(inflow.direction)
    up, across = section_axes(direction, scenario.gravity)
    places = inflow.position[None, :]
    if across is not None:
        steps = np.arange(0.0, inflow.width, 0.25 * scenario.dp)
        places = inflow.position + steps[:, None] * across
    ground = ground_of(bed).field.at(np.ascontiguousarray(places[:, :-1]))["height"]
    return np.asarray((ground - places[:, -1]) * up[-1])


def surge_volumes(scenario: Scenario, section: InflowSection) -> tuple[float, float]:
    """What a surge asks for above the ground, and what its layers have, m3 (2-D: m2)."""
    dim, dp = scenario.dim, scenario.dp
    time = np.linspace(section.start, section.stop, INSTANTS)
    thickness = np.interp(time, section.times, section.thickness)
    speed = np.interp(time, section.times, section.speeds)
    bed = _bed_across(scenario, section.name)
    level = thickness[:, None] + _lowest_bed(scenario, section.name)
    width = scenario.inflow[section.name].width if dim == 3 else 1.0
    area = width * np.maximum(level - np.maximum(bed, 0.0), 0.0).mean(axis=1)
    rows = np.searchsorted(np.sort(section.row_height), thickness)
    layer = dp ** (dim - 1) * rows
    return float(np.trapezoid(area * speed, time)), float(np.trapezoid(layer * speed, time))


def _check_outside_walls(
    scenario: Scenario, section: InflowSection, particles: ParticleSet, body_names: list[str]
) -> None:
    """Particles that entered within a wall would be flung out of it.

    On one lattice they are a spacing apart; a section half a spacing off it along the wall meets
    bed particles at 0.7 spacings and is none the worse for it.
    """
    near = 0.6 * scenario.dp
    low, high = section.rows.min(axis=0) - near, section.rows.max(axis=0) + near
    inside = ((particles.position > low) & (particles.position < high)).all(axis=1)
    for p in np.flatnonzero(inside & (particles.motion == FIXED)):
        apart = np.linalg.norm(section.rows - particles.position[p], axis=1)
        if apart.min() < near:
            row = np.round(section.rows[np.argmin(apart)], 9).tolist()
            position = scenario.inflow[section.name].position.tolist()
            raise scenario.where.error(
                ("inflow", section.name, "position"),
                f"inflow.{section.name}.position = {position}: the section lies inside the wall"
                f" {body_names[particles.body[p]]}, at {row} m; keep it"
                f" {near:g} m (0.6 dp) or more from fixed particles",
            )


def above_ground(scenario: Scenario, rows: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Mask (N,) of the rows that lie above a terrain, in the section and in the buffer behind."""
    if scenario.bed is None:
        return np.ones(len(rows), bool)
    ground, lowest = ground_of(scenario.bed), NEAREST * scenario.dp
    behind = _buffer_layers(scenario) * scenario.dp * direction
    places = (rows, rows - 0.5 * behind, rows - behind)
    return np.all([ground.height_above(place) > lowest for place in places], axis=0)


def rows_of(scenario: Scenario, name: str) -> np.ndarray:
    """Centres of the particles of one layer: whole particles along depth and (3-D) width."""
    inflow = scenario.inflow[name]
    direction = inflow.direction / np.linalg.norm(inflow.direction)
    up, across = section_axes(direction, scenario.gravity)
    dp = scenario.dp
    high = _whole(scenario, name, "depth", inflow.height + _lowest_bed(scenario, name))
    wide = 1 if across is None else _whole(scenario, name, "width", inflow.width)
    check_size({f"inflow.{name}": high * wide * (_buffer_layers(scenario) + 1)})
    steps_up = ((np.arange(high) + 0.5) * dp)[:, None] * up
    if across is None:
        return inflow.position + steps_up
    steps_across = ((np.arange(wide) + 0.5) * dp)[:, None] * across
    layer = steps_up[:, None, :] + steps_across[None, :, :]
    return inflow.position + layer.reshape(-1, 3)


def _whole(scenario: Scenario, name: str, key: str, length: float) -> int:
    """The length in whole particles, at least one."""
    count = round(length / scenario.dp)
    if count < 1:
        raise scenario.where.error(
            ("inflow", name, key),
            f"inflow.{name}.{key} = {length:g} is less than one particle (dp = {scenario.dp:g} m)",
        )
    return count


def _buffer_layers(scenario: Scenario) -> int:
    """Enough that layers appear out of sight of a bed that ends one support before the section.

    A bed that saw particles appear without having come would take them for a steady divergence.
    """
    reach = int(np.ceil(scenario.support / scenario.dp - ROUNDING))
    return 2 * reach + 2
