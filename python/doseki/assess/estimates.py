"""Numbers that tell before a run how well its scenario is resolved."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from ..record.particles import BOUND, FIXED, FREE
from ..scenario.bed import Bed
from ..scenario.kinematics import DEFORM
from ..scenario.materials import Material
from ..scenario.model import Scenario
from ..scene.ground import ground_of
from ..scene.inflow_sections import build_inflows
from .pouring import Cells, Fall

State = Mapping[str, np.ndarray]
MOST = 0.9  # of the particles of a flow on a map of steps
SOLID_COURANT = 0.65  # steps of waves in bodies that deform, of dp/c_P


def grain_spacings(scenario: Scenario) -> float | None:
    """Particles across a grain, where the scenario has grains (a parameter `diameter`)."""
    diameter = scenario.constants.get("diameter")
    return None if not isinstance(diameter, int | float) else diameter / scenario.dp


def flow_depths(scenario: Scenario, state: State, names: dict[int, str]) -> dict[str, float]:
    """Particles over the depth of each body of fluid, and of each inflow."""
    fluids = [
        i for i, n in enumerate(scenario.material_names) if scenario.materials[n].law == "fluid"
    ]
    depths = {name: inflow.height / scenario.dp for name, inflow in scenario.inflow.items()}
    for body, name in names.items():
        of_it = (
            (state["body"] == body) & (state["motion"] == FREE) & np.isin(state["material"], fluids)
        )
        if of_it.any() and name not in depths:
            position = state["position"][of_it]
            depths[name] = float(_extent(position, scenario).min()) + 1.0
            if scenario.bed is not None:
                depths[name] = min(depths[name], _depth_above(scenario.bed, position, scenario.dp))
    return depths


def _depth_above(bed: Bed, position: np.ndarray, dp: float) -> float:
    """Particles over the depth of a flow on a map.

    On steps a few particles stand out, from treads to risers, so that most of them are asked.
    """
    height = ground_of(bed.evened).height_above(position) / dp
    return float(height.max() + 0.5 if bed.terraces is None else np.quantile(height, MOST) / MOST)


def step_ends(scenario: Scenario) -> list[float]:
    """Times between what ends a step exactly, s: outputs, and rows of the history."""
    rows = [scenario.time_history] if scenario.rows_end_steps else []
    return [*scenario.sampled_intervals, *rows]


def wave_speed(material: Material) -> float:
    """c_P of plane waves of compression, m/s."""
    modulus, ratio = material.elasticity
    stiff = modulus * (1 - ratio) / ((1 + ratio) * (1 - 2 * ratio))
    return math.sqrt(stiff / material.rho0)


def solid_steps_text(dt: float, duration: float) -> str:
    """What a `solid_timestep`, s, means for a run of some duration, s."""
    return (
        f"within these, steps of about {dt:.2g} s while a body deforms: some {duration / dt:,.0f} "
        "of them if one deforms all the time"
    )


def solid_timestep(scenario: Scenario) -> float | None:
    """About how long the steps of bodies are while they deform, s; None where none does.

    Eq. (84), which they have, also knows their shape and damping, and cracks.
    """
    steps = [
        SOLID_COURANT
        * (body.given("dp") or scenario.dp)
        / wave_speed(scenario.materials[body.material])
        for name, body in scenario.body.items()
        if body.material is not None and scenario.kinematics_of(name).name in DEFORM
    ]
    return min(steps, default=None)


def mach_number(scenario: Scenario, state: State) -> tuple[float, float] | None:
    """Largest speed to expect, m/s, and what it is in sound speeds of the slowest material.

    The speed is that of the start, of an inflow or of a wall that goes (not: turns), or of a free
    fall through all of the scene. In a basin that stays closed it is that of a fall to the lowest
    place without water, or of waves, whichever is larger. In the resolved scheme bodies have no
    such sound: None where there is nothing else.
    """
    if scenario.has_bodies_alone:
        return None
    free = state["motion"] != FIXED
    speeds = np.linalg.norm(state["velocity"][free], axis=1)
    given = max(float(speeds.max(initial=0.0)), *(_given_speeds(scenario)), 0.0)
    expected = math.sqrt(given**2 + 2 * _fall(scenario, state))
    return expected, expected / (scenario.min_sound_speed * scenario.xi)


def _given_speeds(scenario: Scenario) -> Iterator[float]:
    yield 0.0
    for section in build_inflows(scenario, list(scenario.inflow)):
        yield section.speed
    for body in scenario.body.values():
        motion = body.prescribed_motion
        if motion is not None and motion.velocity is not None:
            yield float(np.linalg.norm(motion.velocity))


def _fall(scenario: Scenario, state: State) -> float:
    """g times the height that particles can fall through, m2/s2."""
    through, in_basin = _fall_through(scenario, state), _fall_in_basin(scenario, state)
    return through if in_basin is None else min(through, in_basin)


def _fall_through(scenario: Scenario, state: State) -> float:
    """The same where they may fall through all of the scene."""
    moving = np.isin(state["motion"], (FREE, BOUND))
    along = state["position"] @ scenario.gravity
    starts = [along[moving].min()] if moving.any() else []
    starts += [float(inflow.position @ scenario.gravity) for inflow in scenario.inflow.values()]
    return float(along.max(initial=max(starts)) - min(starts)) if starts else 0.0


def _fall_in_basin(scenario: Scenario, state: State) -> float | None:
    """The same where what moves cannot leave its basin, or half the square of the speed of waves.

    Water does not fall through water that is there already. None of a scene that is open, that
    changes its walls, or that is too large to be looked at.
    """
    fall = Fall.of(scenario)
    wraps = ["xyz".index(axis) for axis in scenario.periodic]
    changes = any(body.prescribed_motion is not None for body in scenario.body.values())
    if fall is None or scenario.bed is not None or scenario.inflow or changes:
        return None
    fixed = state["motion"] == FIXED
    points = state["position"][~fixed]
    if np.any(scenario.gravity[wraps]) or not len(points):
        return None
    cells = Cells.of(scenario, state["position"][fixed], [points])
    fastest = float(np.linalg.norm(state["velocity"][~fixed], axis=1).max())
    head = fall.head(points, fastest)
    if cells.is_coarse or cells.poured(points, head, fall):
        return None
    height = fall.height(points)
    drop = float(height.max()) - cells.lowest_room(points, head, fall)
    return fall.g * max(drop, 0.5 * float(np.ptp(height) + scenario.dp))


def _extent(position: np.ndarray, scenario: Scenario) -> np.ndarray:
    """Extent of particles along axes that are not periodic, in spacings."""
    axes = [a for a in range(scenario.dim) if "xyz"[a] not in scenario.periodic]
    return np.ptp(position[:, axes], axis=0) / scenario.dp if axes else np.array([np.inf])


def gap(one: np.ndarray, other: np.ndarray, reach: float) -> float:
    """Least distance between two sets of points (n, dim), m; inf if it is over `reach`."""
    from scipy.spatial import cKDTree

    distance, _ = cKDTree(other).query(one, distance_upper_bound=reach * (1 + 1e-9))
    return float(distance.min())
