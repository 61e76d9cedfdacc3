"""Inflow sections: where particles enter, how fast, and in which pattern."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..record.particles import FIXED, ParticleSet, check_size
from ..scenario.model import Scenario
from ..scenario.values.directions import section_axes
from .ground import beyond_text, ground_of
from .lattices import ROUNDING

TINY = 1e-300  # m/s; in place of 0 in what is divided by
INSTANTS = 2000  # at which the volume of a surge is looked at
NEAREST = 0.4  # spacings between an inflow and a terrain
NEAREST_WALL = 0.6  # between it and fixed particles
MOST_ROWS_MORE = 8  # on top of those of the depth, for what banks take
PLACED_BY = "its position, direction, width and depth say where it is"


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
    row_height: np.ndarray  # (n,) the thickness from which a layer has each particle, m

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

    def gone(self, time: np.ndarray | float) -> np.ndarray:
        """How far layers have gone by each time, s, in m."""
        t = np.clip(time, self.start, self.stop)
        k = np.clip(np.searchsorted(self.times, t, "right") - 1, 0, len(self.times) - 2)
        since, speed = t - self.times[k], np.interp(t, self.times, self.speeds)
        return np.asarray(self.distances[k] + 0.5 * (self.speeds[k] + speed) * since)

    def time_of(self, distance: np.ndarray) -> np.ndarray:
        """When layers have gone so far, m, in s: the inverse of `gone`."""
        far = np.minimum(distance, self.distances[-1])
        k = np.clip(np.searchsorted(self.distances, far, "right") - 1, 0, len(self.times) - 2)
        lasts = np.diff(self.times)  # no time at all where a surge jumps
        slope = np.diff(self.speeds) / np.where(lasts > 0, lasts, np.inf)
        more = far - self.distances[k]
        then = np.sqrt(np.maximum(self.speeds[k] ** 2 + 2 * slope[k] * more, 0.0))
        return np.asarray(self.times[k] + 2 * more / np.maximum(self.speeds[k] + then, TINY))

    def entered(self, time: np.ndarray) -> np.ndarray:
        """Particles that have entered by each time, s, a fraction of a layer included."""
        return self.gone(time) / self.spacing * len(self.rows)


def build_inflows(
    scenario: Scenario, body_names: list[str], particles: ParticleSet | None = None
) -> list[InflowSection]:
    """The inflow sections; `body_names` are those of `build_bodies`.

    Raises UserError, also where a section lies inside a wall of the `particles` given, or the
    layers behind it inside what moves.
    """
    sections = [_section(scenario, name, body_names.index(name)) for name in scenario.inflow]
    if particles is not None:
        for section in sections:
            _check_clear(scenario, section, particles, body_names)
    return sections


def _section(scenario: Scenario, name: str, body: int) -> InflowSection:
    inflow, dp, dim = scenario.inflow[name], scenario.dp, scenario.dim
    material = scenario.materials[inflow.material]
    direction = inflow.along
    rows = _rows_above_ground(scenario, name)
    if not len(rows):
        raise scenario.where.error(
            ("inflow", name, "position"),
            f"inflow.{name}: all of its section lies in the ground; {PLACED_BY}",
        )
    _check_on_map(scenario, name, rows)
    times, rate = inflow.rows.T
    area = len(rows) * dp ** (dim - 1) * (inflow.width if dim == 2 else 1.0)
    speeds, thickness, heights = rate / area, np.zeros(0), np.zeros(0)
    if inflow.surge is not None:
        _, thickness, speeds = np.array(inflow.surge, dtype=float).T
        heights = _appearance(scenario, name, rows)
    _check_speed(scenario, name, float(speeds.max()))
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


def _check_speed(scenario: Scenario, name: str, fastest: float) -> None:
    sound = scenario.xi * scenario.min_sound_speed
    if fastest > sound:
        raise scenario.where.error(
            ("inflow", name),
            f"inflow.{name}: enters at up to {fastest:.3g} m/s, faster than sound in this run, "
            f"{sound:.3g} m/s; take less, a larger section, or raise {scenario.sound_speed_key[0]}",
        )


def _rows_above_ground(scenario: Scenario, name: str) -> np.ndarray:
    """The rows of a layer that lie above a terrain; of a surge as many as its largest area needs.

    Where banks leave no room for particles, more of them lie on top, higher than the thickness.
    """
    inflow, needed, most_more = scenario.inflow[name], 0.0, 0
    if inflow.surge is not None:
        needed = _areas(scenario, name, np.array([inflow.height]))[0] / _cell(scenario)
        most_more = MOST_ROWS_MORE
    direction = inflow.along
    for more in range(most_more + 1):
        rows = rows_of(scenario, name, more)
        rows = rows[above_ground(scenario, rows, direction)]
        if len(rows) >= needed:
            break
    return rows


def _check_on_map(scenario: Scenario, name: str, rows: np.ndarray) -> None:
    """Refuse a section beyond the map, where all that enters would leave at once."""
    if scenario.bed is None:
        return
    places = np.ascontiguousarray(rows[:, :-1])
    unknown = ground_of(scenario.bed).field.at(places)["unknown"].astype(bool)
    if unknown.any():
        raise scenario.where.error(
            ("inflow", name, "position"),
            f"inflow.{name}: its section {beyond_text(places[unknown][0])}; {PLACED_BY}",
        )


def height_above_ground(scenario: Scenario, name: str) -> float:
    """How far the foot of a section is above the ground at least, m; 0 where a part is in it."""
    return 0.0 if scenario.bed is None else max(0.0, -float(_bed_across(scenario, name).max()))


def _cell(scenario: Scenario) -> float:
    """Area of a section that a particle takes, m2 (2-D: m)."""
    return float(scenario.dp ** (scenario.dim - 1))


def _appearance(scenario: Scenario, name: str, rows: np.ndarray) -> np.ndarray:
    """The thickness (n,), m, from which a layer of a surge has each particle.

    Particles fill the section from below, of one height first where it is widest, and there are at
    any time as many as the area of the surge above the ground has room for.
    """
    inflow = scenario.inflow[name]
    direction = inflow.along
    up, across = section_axes(direction, scenario.gravity)
    height = np.round((rows - inflow.position) @ up / scenario.dp, 6)
    aside = np.zeros(len(rows)) if across is None else (rows - inflow.position) @ across
    lowest = aside[height == height.min()].mean()
    order = np.lexsort((aside, np.round(abs(aside - lowest) / scenario.dp, 6), height))
    thickness = np.linspace(0.0, 2.0 * inflow.height, INSTANTS)
    area = _areas(scenario, name, thickness)
    found = np.empty(len(rows))
    found[order] = np.interp((np.arange(len(rows)) + 0.5) * _cell(scenario), area, thickness)
    return found


def _areas(scenario: Scenario, name: str, thickness: np.ndarray) -> np.ndarray:
    """Area (k,) of a surge above the ground at each thickness (k,), m2 (2-D: m)."""
    width = scenario.inflow[name].width if scenario.dim == 3 else 1.0
    if scenario.bed is None:
        return np.asarray(width * thickness)
    bed = np.maximum(_bed_across(scenario, name), 0.0)
    level = thickness[:, None] + _lowest_bed(scenario, name)
    return np.asarray(width * np.maximum(level - bed, 0.0).mean(axis=1))


def _lowest_bed(scenario: Scenario, name: str) -> float:
    """How far the bed of a terrain lies above the foot of the section of a surge at least, m."""
    if scenario.bed is None or scenario.inflow[name].surge is None:
        return 0.0
    return max(0.0, float(_bed_across(scenario, name).min()))


def _bed_across(scenario: Scenario, name: str) -> np.ndarray:
    """Heights (n,) of the bed of a terrain above the foot of a section, evenly across it, m."""
    inflow, bed = scenario.inflow[name], scenario.bed
    assert bed is not None
    direction = inflow.along
    up, across = section_axes(direction, scenario.gravity)
    places = inflow.position[None, :]
    if across is not None:
        steps = np.arange(0.0, inflow.width, 0.25 * scenario.dp)
        places = inflow.position + steps[:, None] * across
    ground = ground_of(bed).field.at(np.ascontiguousarray(places[:, :-1]))["height"]
    return np.asarray((ground - places[:, -1]) * up[-1])


def surge_volumes(scenario: Scenario, section: InflowSection) -> tuple[float, float]:
    """What a surge asks for above the ground, and what its layers have, m3 (2-D: m2)."""
    time = np.linspace(section.start, section.stop, INSTANTS)
    thickness = np.interp(time, section.times, section.thickness)
    asked = _areas(scenario, section.name, thickness) * np.interp(
        time, section.times, section.speeds
    )
    return float(np.trapezoid(asked, time)), _of_layers(scenario, section, section.stop)


def to_enter(scenario: Scenario, section: InflowSection) -> tuple[float, float]:
    """What is to enter during the run, m3, and the largest discharge, m3/s (2-D: per metre).

    Of a surge both are those of its layers, as in the ledger of the run.
    """
    inflow, start, end = scenario.inflow[section.name], scenario.begins_at, scenario.time_max
    if inflow.surge is None:
        across = 1.0 if scenario.dim == 3 else inflow.width
        return inflow.volume_between(start, end) / across, inflow.peak_rate / across
    time, rows = _layers(section, section.stop)
    rate = rows * np.interp(time, section.times, section.speeds)
    before, by = (_of_layers(scenario, section, each) for each in (start, end))
    return by - before, _cell(scenario) * float(rate.max())


def _of_layers(scenario: Scenario, section: InflowSection, time: float) -> float:
    """What the layers of a surge have brought by a time, s, m3 (2-D: m2), the last one in part."""
    _, rows = _layers(section, time)
    share = np.minimum(float(section.gone(time)) / section.spacing - np.arange(len(rows)), 1.0)
    return _cell(scenario) * section.spacing * float(rows @ share)


def _layers(section: InflowSection, last: float) -> tuple[np.ndarray, np.ndarray]:
    """When the middle of each layer (k,) of a surge crosses until a time, s, and its particles."""
    number = np.arange(math.ceil(float(section.gone(last)) / section.spacing))
    time = section.time_of((number + 0.5) * section.spacing)
    thickness = np.interp(time, section.times, section.thickness)
    return time, np.searchsorted(np.sort(section.row_height), thickness)


def _check_clear(
    scenario: Scenario, section: InflowSection, particles: ParticleSet, body_names: list[str]
) -> None:
    """Refuse a section in a wall, from which particles would be flung, and layers in what moves.

    On one lattice particles are a spacing apart; a section half a spacing off it along the wall
    meets bed particles at 0.7 spacings and is none the worse for it.  No place inside a lattice is
    farther than half the diagonal of a cell from its particles.
    """
    carried = np.isin(particles.body, [body_names.index(name) for name in scenario.carried])
    wall = particles.motion == FIXED
    behind = -(np.arange(section.buffer_layers) + 0.5)[:, None] * section.spacing
    buffer = (section.rows[:, None] + behind * section.direction).reshape(-1, scenario.dim)
    half_diagonal = 0.51 * math.sqrt(scenario.dim)
    for layers, which, spacings, what, whose in (
        (section.rows, wall, NEAREST_WALL, "the section lies inside the wall", "fixed particles"),
        (buffer, ~wall & ~carried, half_diagonal, "its layers begin inside", "what moves"),
    ):
        near = spacings * scenario.dp
        met = np.flatnonzero(which)
        p, place = _first_met(particles.position[met], layers, near)
        if p is not None:
            position = scenario.inflow[section.name].position.tolist()
            raise scenario.where.error(
                ("inflow", section.name, "position"),
                f"inflow.{section.name}.position = {position}: {what} "
                f"{body_names[particles.body[met[p]]]}, at {place} m; keep it {near:.3g} m "
                f"({spacings:.3g} dp) or more from {whose}",
            )


def _first_met(
    position: np.ndarray, places: np.ndarray, near: float
) -> tuple[int | None, list[float]]:
    """The first of the positions (N, dim) nearer than this to one of the places, and that place."""
    from scipy.spatial import cKDTree

    apart, nearest = cKDTree(places).query(position, distance_upper_bound=near)
    met = np.flatnonzero(np.isfinite(apart))
    if not len(met):
        return None, []
    return int(met[0]), np.round(places[nearest[met[0]]], 9).tolist()


def above_ground(scenario: Scenario, rows: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Mask (N,) of the rows that lie above a terrain, in the section and in the buffer behind."""
    if scenario.bed is None:
        return np.ones(len(rows), bool)
    ground, lowest = ground_of(scenario.bed), NEAREST * scenario.dp
    behind = _buffer_layers(scenario) * scenario.dp * direction
    places = (rows, rows - 0.5 * behind, rows - behind)
    return np.all([ground.height_above(place) > lowest for place in places], axis=0)


def rows_of(scenario: Scenario, name: str, more: int = 0) -> np.ndarray:
    """Centres of the particles of one layer: whole particles along depth and (3-D) width.

    There are so many rows `more` on top.
    """
    inflow = scenario.inflow[name]
    direction = inflow.along
    up, across = section_axes(direction, scenario.gravity)
    dp = scenario.dp
    high = _whole(scenario, name, "depth", inflow.height + _lowest_bed(scenario, name)) + more
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
