"""Where a scene is open: what flows or falls out of it there falls for ever.

A flow is poured into a grid of cells, of which fixed particles fill some: it goes wherever its
energy takes it and no wall is in the way.  Solids, and fluids that can stand still, only fall;
bodies that move as a whole lie on what is below them on each side of their centre of mass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..record.particles import BOUND, DRIVEN, FIXED, FREE
from ..scenario.model import Scenario
from ..scenario.tables.bodies import Grains
from ..scenario.values.directions import section_axes
from ..scene.inflow_sections import build_inflows
from ..util.finding import Finding, place_text
from .estimates import State
from .pouring import Cells, Exits, Fall
from .support import falling, holds, supports

MOST_OF_IT = 0.5  # of a body: it falls with it
SOME_GRAINS = 0.02  # of a packing
REMEDY = "or an [outflow.NAME] in its way, which removes it"


@dataclass(frozen=True)
class OpenSide(Finding):
    """A flow that leaves the scene where nothing catches it."""

    sides: tuple[str, ...]  # such as "+x"
    below: bool  # as well
    first: tuple[float, ...]  # where the flow gets out first, m

    def __str__(self) -> str:
        sides = f"at its side {' and '.join(self.sides)}" if self.sides else ""
        where = " and ".join([*filter(None, [sides]), *(["below"] if self.below else [])])
        x = place_text(self.first)
        return (
            f"{self.place}: the scene is open {where}; what gets out there, first near [{x}] m,"
            f" falls for ever: add a wall, {REMEDY}"
        )


@dataclass(frozen=True)
class NothingBelow(Finding):
    """A body over nothing, or whose centre of mass is."""

    beside: bool = False  # whether there is something below a part of it

    def __str__(self) -> str:
        if self.beside:
            said = "what is below it lies on one side of its centre of mass"
            return f"{self.place}: {said}, and it falls for ever: add a wall, {REMEDY}"
        return f"{self.place}: no wall is below it and it falls for ever: add one, {REMEDY}"


@dataclass(frozen=True)
class _Source:
    """Where something moves at the start, or enters."""

    name: str
    points: np.ndarray  # (n, dim), m
    speed: float  # m/s
    is_whole: bool = False  # a rigid or deformable body


def open_sides(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[Finding]:
    """A finding for each body or inflow that will fall for ever, within the time of the run."""
    fall = Fall.of(scenario)
    if fall is None or scenario.bed is not None:  # what leaves a map leaves the run
        return
    flows, others = _flows(scenario, state, names), _solids(scenario, state, names)
    inflows = list(_inflows(scenario))
    if not flows and not inflows and not others:
        return
    walls = _walls(scenario, state, names, inflows, fall)
    cells = Cells.of(scenario, walls, [state["position"], *(s.points for s in inflows)])
    for source in [*flows, *inflows]:
        exits = cells.poured(source.points, fall.head(source.points, source.speed), fall)
        exits = exits.within_reach(source.points, source.speed, fall)
        if exits:
            yield _open_side(source, exits, fall)
    yield from _falling(scenario, others, cells, fall)


def _falling(
    scenario: Scenario, sources: list[_Source], cells: Cells, fall: Fall
) -> Iterator[NothingBelow]:
    """A finding for each that neither walls hold nor others that are held."""
    while True:
        found = [(source, _fall_of(scenario, source, cells, fall)) for source in sources]
        held = [source.points for source, finding in found if source.is_whole and not finding]
        sources = [source for source, finding in found if finding]
        if not held or not sources:
            break
        cells = cells.filled(np.concatenate(held))
    yield from (finding for _, finding in found if finding)


def _fall_of(scenario: Scenario, source: _Source, cells: Cells, fall: Fall) -> NothingBelow | None:
    """What is found of a body that walls in the cells do not hold."""
    is_grains = isinstance(scenario.body.get(source.name), Grains)
    if is_grains or not source.is_whole:
        share = falling(cells, source.points, source.speed, fall)
        falls = share > (SOME_GRAINS if is_grains else MOST_OF_IT)
        return NothingBelow(source.name) if falls else None
    met = supports(cells, source.points, source.speed, fall)
    if holds(cells, source.points, met, fall):
        return None
    return NothingBelow(source.name, bool(met.any()))


def _open_side(source: _Source, exits: Exits, fall: Fall) -> OpenSide:
    first = exits.nearest(source.points)
    below = [fall.is_below(axis, sign) for axis, sign in exits.sides]
    sides = [
        f"{'+' if sign > 0 else '-'}{'xyz'[axis]}"
        for (axis, sign), is_below in zip(exits.sides, below, strict=True)
        if not is_below
    ]
    return OpenSide(source.name, tuple(sides), any(below), tuple(float(x) for x in first))


def _flows(scenario: Scenario, state: State, names: dict[int, str]) -> list[_Source]:
    """The bodies of fluid that do not stand still by themselves."""
    return _sources(state, names, (state["motion"] == FREE) & _is_fluid(scenario, state))


def _solids(scenario: Scenario, state: State, names: dict[int, str]) -> list[_Source]:
    """The bodies that only fall; those that are clamped do not."""
    moves = np.isin(state["motion"], (FREE, BOUND))
    found = _sources(state, names, moves & ~_is_fluid(scenario, state))
    tables = scenario.body
    return [s for s in found if s.name not in tables or tables[s.name].given("clamped") is None]


def _is_fluid(scenario: Scenario, state: State) -> np.ndarray:
    """Mask (N,) of the particles that flow however small their slope is."""
    materials = [scenario.materials[name] for name in scenario.material_names]
    flows = [m.law == "fluid" and m.rheology == "newtonian" for m in materials]
    return np.array(flows)[state["material"]]


def _sources(state: State, names: dict[int, str], mask: np.ndarray) -> list[_Source]:
    found = []
    for body, name in names.items():
        of_it = mask & (state["body"] == body)
        if of_it.any():
            speed = np.linalg.norm(state["velocity"][of_it], axis=1).max()
            is_whole = bool(np.all(state["motion"][of_it] == BOUND))
            found.append(_Source(name, state["position"][of_it], float(speed), is_whole))
    return found


def _inflows(scenario: Scenario) -> Iterator[_Source]:
    """Points of each section, half a spacing apart."""
    for section in build_inflows(scenario, list(scenario.inflow)):
        inflow, direction = scenario.inflow[section.name], section.direction
        up, across = section_axes(direction, scenario.gravity)
        points = inflow.position + np.arange(0, inflow.height, 0.5 * scenario.dp)[:, None] * up
        if across is not None:
            beside = np.arange(0, inflow.width, 0.5 * scenario.dp)[:, None] * across
            points = (points[:, None] + beside[None]).reshape(-1, scenario.dim)
        yield _Source(section.name, points + 2 * scenario.dp * direction, section.speed)


def _walls(
    scenario: Scenario,
    state: State,
    names: dict[int, str],
    inflows: list[_Source],
    fall: Fall,
) -> np.ndarray:
    """Points (n, dim) that nothing passes: what stays fixed or is clamped, inflows from behind."""
    stays = state["motion"] == FIXED
    for body, name in names.items():
        table = scenario.body.get(name)
        motion = table.prescribed_motion if table is not None else None
        if motion is not None and motion.removed_at is not None:
            stays &= state["body"] != body
        if table is not None and table.given("clamped") is not None:
            stays |= state["body"] == body
    walls = [state["position"][stays], state["position"][state["motion"] == DRIVEN]]
    for source in inflows:
        inflow = scenario.inflow[source.name]
        direction = inflow.along
        behind = source.points - 4 * scenario.dp * direction
        walls.append(behind)
        top = behind[fall.height(behind) > fall.height(behind).max() - scenario.dp]
        up, _ = section_axes(direction, scenario.gravity)
        raised = np.arange(0, source.speed**2 / fall.g + 4 * scenario.dp, 0.5 * scenario.dp)
        walls.append((top[:, None] + raised[None, :, None] * up).reshape(-1, scenario.dim))
    return np.concatenate(walls)
