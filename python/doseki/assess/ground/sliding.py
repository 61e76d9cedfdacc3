"""Points that slide over the ground from where fluid starts or enters: how far a flow may get."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...record.particles import FREE
from ...scenario.materials import Material
from ...scenario.model import Scenario
from ...scene.ground import Ground, ground_of
from ...scene.inflow_sections import build_inflows
from ..estimates import State

MAX_CELLS = 600  # that points start from
MAX_STEPS = 800
STILL = 1e-3  # m/s


@dataclass(frozen=True)
class Swept:
    """Square cells of the plan that a flow comes over."""

    place: np.ndarray  # (n, dim - 1) middle of each, m
    cell: float  # side, m
    times: np.ndarray  # (k,) s
    covered: np.ndarray  # (k,) how many it is over by then

    def more(self, time: np.ndarray) -> np.ndarray:
        """Cells (n,) beyond those of the start at times, s."""
        return np.maximum(0.0, np.interp(time, self.times, self.covered) - self.covered[0])


@dataclass(frozen=True, eq=False)
class Sliding:
    """A scene as it starts, and the ground that its fluid may come over."""

    scenario: Scenario
    state: State
    names: list[str]  # of bodies

    @cached_property
    def swept(self) -> Swept | None:
        """That ground, found when it is first asked for."""
        return swept_ground(self.scenario, self.state, self.names)


class _Source(NamedTuple):
    """Fluid that sets out."""

    place: np.ndarray  # (n, dim - 1), m
    velocity: np.ndarray  # (n, dim), m/s
    height: np.ndarray  # (n,) above the ground, m
    fluid: Material


@dataclass
class _Points:
    """Points that slide, each with what brakes it."""

    place: np.ndarray  # (n, dim - 1), m
    velocity: np.ndarray  # (n, dim), m/s
    depth: np.ndarray  # (n,) of the flow, m
    friction: np.ndarray  # (n,) coefficient of friction
    drag: np.ndarray  # (n,) 1/s
    turbulent: np.ndarray  # (n,) 1/m

    def where(self, kept: np.ndarray) -> _Points:
        """Some of them."""
        return _Points(**{name: values[kept] for name, values in vars(self).items()})


def swept_ground(scenario: Scenario, state: State, names: list[str]) -> Swept | None:
    """The ground that fluid may come over until the end; None where no fluid meets a terrain.

    Of each column of the flow, points slide off in all directions as fast as its depth lets them
    fall, each braked as the bed brakes a flow of that depth.  They do not meet, and a flow is
    taken to cover all of their way.
    """
    if scenario.bed is None or scenario.is_dry:
        return None
    ground = ground_of(scenario.bed)
    sources = [*_of_bodies(scenario, ground, state), *_of_inflows(scenario, ground, names)]
    if not sources:
        return None
    cell = _cell(np.concatenate([source.place for source in sources]), scenario.dp)
    points = _joined([_launched(scenario, source, cell) for source in sources])
    times, cells = _slide(scenario, ground, points, cell)
    since = np.repeat(times, [len(each) for each in cells])
    place, first, _ = _each_once(np.vstack(cells))
    covered = np.searchsorted(np.sort(since[first]), times, "right")
    return Swept((place + 0.5) * cell, cell, np.array(times), covered)


def _of_bodies(scenario: Scenario, ground: Ground, state: State) -> list[_Source]:
    """Places, velocities and heights above the ground of the fluid that is there, by material."""
    found = []
    for name in scenario.liquids:
        of_it = state["material"] == scenario.material_names.index(name)
        of_it &= state["motion"] == FREE
        if of_it.any():
            x = state["position"][of_it]
            found.append(_above(ground, x, state["velocity"][of_it], scenario.materials[name]))
    return found


def _of_inflows(scenario: Scenario, ground: Ground, names: list[str]) -> list[_Source]:
    """The same of the layers of inflows."""
    return [
        _above(
            ground,
            section.rows,
            np.tile(section.speed * section.direction, (len(section.rows), 1)),
            scenario.materials[scenario.material_names[section.material]],
        )
        for section in build_inflows(scenario, names)
    ]


def _above(ground: Ground, x: np.ndarray, velocity: np.ndarray, fluid: Material) -> _Source:
    place = np.ascontiguousarray(x[:, :-1])
    return _Source(place, velocity, x[:, -1] - ground.field.at(place)["height"], fluid)


def _cell(place: np.ndarray, dp: float) -> float:
    """The side of cells of which points start from MAX_CELLS or fewer, m."""
    columns, side = _each_once(_numbers(place, dp))[0], dp
    while len(columns) > MAX_CELLS:
        columns, side = _each_once(columns // 2)[0], 2 * side
    return side


def _numbers(place: np.ndarray, cell: float) -> np.ndarray:
    """The cells that places (n, dim - 1) are in, in numbers of cells from 0."""
    return np.floor(place / cell).astype(np.int64)


def _each_once(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells (n, dim - 1) in order, each once, the first row of each, and which of them rows are."""
    order = np.lexsort(cells.T[::-1])
    in_order = cells[order]
    is_new = np.ones(len(cells), bool)
    is_new[1:] = (in_order[1:] != in_order[:-1]).any(axis=1)
    of_it = np.empty(len(cells), np.int64)
    of_it[order] = np.cumsum(is_new) - 1
    return in_order[is_new], order[is_new], of_it


def _launched(scenario: Scenario, source: _Source, cell: float) -> _Points:
    """Points that set out from each column of a fluid."""
    columns, _, of_it = _each_once(_numbers(source.place, cell))
    count = np.bincount(of_it)
    depth = np.zeros(len(columns))
    np.maximum.at(depth, of_it, source.height + 0.5 * scenario.dp)
    mean = [np.bincount(of_it, v) / count for v in source.velocity.T]
    g = float(np.linalg.norm(scenario.gravity))
    inside = _inside(source.fluid)
    fall = np.sqrt(2 * g * depth) / (1 + inside)
    ways = _ways(scenario.dim)
    start = np.repeat((columns + 0.5) * cell, len(ways), axis=0)
    depth, fall = (np.repeat(values, len(ways)) for values in (depth, fall))
    given = np.repeat(np.column_stack(mean), len(ways), axis=0)
    given[:, :-1] += fall[:, None] * np.tile(ways, (len(columns), 1))
    return _Points(start, given, depth, *_brakes(scenario, source.fluid, depth, g))


def _ways(dim: int) -> np.ndarray:
    """Directions (n, dim - 1) in which points set out, and none."""
    if dim == 2:
        return np.array([[0.0], [1.0], [-1.0]])
    turn = np.arange(8) * np.pi / 4
    return np.vstack([[0.0, 0.0], np.column_stack([np.cos(turn), np.sin(turn)])])


def _inside(fluid: Material) -> float:
    """The coefficient of friction of grains that a fluid is made of."""
    if fluid.rheology != "mu_i":
        return 0.0
    return fluid.of_laws["mu_s"] * (1 - fluid.of_laws["pore_pressure_ratio"])


def _brakes(
    scenario: Scenario, fluid: Material, depth: np.ndarray, g: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Friction, drag and turbulent friction of a flow of these depths on the terrain."""
    terrain, nothing = scenario.terrain, np.zeros(len(depth))
    assert terrain is not None
    if terrain.wall == "free_slip":
        return nothing, nothing, nothing
    if terrain.wall == "voellmy":
        xi = terrain.turbulent_xi
        turbulent = nothing if xi is None else g / (xi * depth)
        return nothing + (terrain.mu or 0.0), nothing, turbulent
    held = fluid.of_laws["yield_stress"] / (fluid.rho0 * g * depth)
    return _inside(fluid) + held, 3 * fluid.nu / depth**2, nothing


def _joined(parts: list[_Points]) -> _Points:
    return _Points(
        **{name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])}
    )


def _slide(
    scenario: Scenario, ground: Ground, points: _Points, cell: float
) -> tuple[list[float], list[np.ndarray]]:
    """Times, s, and the cells in which points are by then, each once, until the end of the run."""
    now, end = scenario.begins_at, scenario.time_max
    longest = (end - now) / MAX_STEPS
    times, cells = [now], [_cells(points, cell)]
    while now < end and len(points.place):
        fastest = float(np.linalg.norm(points.velocity, axis=1).max())
        dt = min(end - now, max(longest, min(0.5 * cell / (fastest + STILL), 8 * longest)))
        now += dt
        points = _stepped(scenario.gravity, ground, points, dt)
        times.append(now)
        cells.append(_cells(points, cell))
    return times, cells


def _cells(points: _Points, cell: float) -> np.ndarray:
    """The cells that points are in, in numbers of cells from 0, each once."""
    return _each_once(_numbers(points.place, cell))[0]


def _stepped(gravity: np.ndarray, ground: Ground, points: _Points, dt: float) -> _Points:
    """Points after a step, without those that left the map."""
    surface = ground.field.at(np.ascontiguousarray(points.place))
    normal = surface["normal"]
    v = points.velocity
    speed = np.linalg.norm(v, axis=1)
    along = v - (v * normal).sum(axis=1)[:, None] * normal
    along *= (speed / np.maximum(np.linalg.norm(along, axis=1), 1e-12))[:, None]
    pressing = -(normal @ gravity)
    along += dt * (gravity + pressing[:, None] * normal)
    speed = np.linalg.norm(along, axis=1)
    left = np.maximum(0.0, speed - dt * points.friction * pressing)
    left /= 1 + dt * (points.drag + points.turbulent * left)
    v = along * (left / np.maximum(speed, 1e-12))[:, None]
    moved = _Points(**vars(points) | {"place": points.place + dt * v[:, :-1], "velocity": v})
    return moved.where(surface["unknown"] == 0)
