"""Warnings before a run: what is likely to go wrong, with the remedy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from .gauges import outside_everything
from .particles import BOUND, DRIVEN, FIXED, FREE
from .scenario import Scenario
from .schema import Box
from .schemes import UETA2022

State = Mapping[str, np.ndarray]

LEAST_ACROSS_GRAIN = 6  # particles; below, a grain is not resolved
LEAST_ACROSS_FLOW = 10  # particles over the depth; below, a film is too viscous
HIGHEST_MACH = 0.1  # for which weak compressibility is a good approximation
TOUCHING = 1.5  # spacings; beyond, two bodies are apart


def findings(scenario: Scenario, state: State, body_names: list[str]) -> list[str]:
    """One sentence for each doubt about the particles of `state` (the core's fields)."""
    names = dict(enumerate(body_names))
    found = [*scenario.warnings, *_grains(scenario), *_flow_depth(scenario, state, names)]
    found += [*_walls(scenario, state, names), *_roughness(scenario, state, names)]
    found += [*_gauges(scenario, state), *_mach(scenario, state)]
    return list(dict.fromkeys(found))


def thorough_findings(scenario: Scenario, state: State, body_names: list[str]) -> list[str]:
    """Those of `findings`, and those that take a while to find."""
    names = dict(enumerate(body_names))
    return [*findings(scenario, state, body_names), *_detached(scenario, state, names)]


def grain_spacings(scenario: Scenario) -> float | None:
    """Particles across a grain, where the scenario has grains (a parameter `diameter`)."""
    diameter = scenario.constants.get("diameter")
    return None if not isinstance(diameter, int | float) else diameter / scenario.dp


def flow_depths(scenario: Scenario, state: State, names: dict[int, str]) -> dict[str, float]:
    """Particles over the depth of each body of fluid, and of each inflow."""
    fluids = [
        i for i, n in enumerate(scenario.material_names) if scenario.materials[n].law == "fluid"
    ]
    depths = {name: inflow.depth / scenario.dp for name, inflow in scenario.inflow.items()}
    for body, name in names.items():
        of_it = (
            (state["body"] == body) & (state["motion"] == FREE) & np.isin(state["material"], fluids)
        )
        if of_it.any() and name not in depths:
            depths[name] = float(_extent(state["position"][of_it], scenario).min()) + 1.0
    return depths


def mach_number(scenario: Scenario, state: State) -> tuple[float, float]:
    """Largest speed to expect, m/s, and what it is in sound speeds of the slowest material.

    The speed is that of the start, of an inflow or of a wall that goes (not: turns), or of a free
    fall through all of the scene.
    """
    free = state["motion"] != FIXED
    speeds = np.linalg.norm(state["velocity"][free], axis=1)
    given = max(float(speeds.max(initial=0.0)), *(_given_speeds(scenario)), 0.0)
    expected = math.sqrt(given**2 + 2 * _fall(scenario, state))
    slowest = min(scenario.materials[name].speedsound for name in scenario.material_names)
    return expected, expected / (slowest * scenario.xi)


def _given_speeds(scenario: Scenario) -> Iterator[float]:
    yield 0.0
    for inflow in scenario.inflow.values():
        yield inflow.peak_rate / (inflow.depth * inflow.width)
    for body in scenario.body.values():
        motion = getattr(body, "motion", None)
        if motion is not None and motion.velocity is not None:
            yield float(np.linalg.norm(motion.velocity))


def _fall(scenario: Scenario, state: State) -> float:
    """g times the height that particles can fall through, m2/s2."""
    moving = np.isin(state["motion"], (FREE, BOUND))
    along = state["position"] @ scenario.gravity
    starts = [along[moving].min()] if moving.any() else []
    starts += [float(inflow.position @ scenario.gravity) for inflow in scenario.inflow.values()]
    return max(0.0, float(along.max() - min(starts))) if starts else 0.0


def _extent(position: np.ndarray, scenario: Scenario) -> np.ndarray:
    """Extent of particles along axes that are not periodic, in spacings."""
    axes = [a for a in range(scenario.dim) if "xyz"[a] not in scenario.periodic]
    return np.ptp(position[:, axes], axis=0) / scenario.dp if axes else np.array([np.inf])


def _grains(scenario: Scenario) -> Iterator[str]:
    across = grain_spacings(scenario) if scenario.scheme == UETA2022 else None
    if across is not None and across < LEAST_ACROSS_GRAIN:
        yield (
            f"{across:.2g} particles across a grain: grains are points that neither roll nor"
            f" collide as bodies; resolved ones need dp = diameter/{LEAST_ACROSS_GRAIN} or less"
        )


def _flow_depth(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[str]:
    for name, across in flow_depths(scenario, state, names).items():
        if across < LEAST_ACROSS_FLOW - 1e-6:
            yield (
                f"{name}: {across:.2g} particles over its depth; below {LEAST_ACROSS_FLOW} it flows"
                f" too slowly: dp = {across * scenario.dp / LEAST_ACROSS_FLOW:.2g} would do"
            )


def _walls(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[str]:
    """A wall thinner than the support lets particles feel its end, or pass it."""
    needed = math.ceil(scenario.support / scenario.dp - 0.5 - 1e-9)
    for body, name in names.items():
        of_it = (state["body"] == body) & (state["motion"] == FIXED)
        if not of_it.any() or not isinstance(scenario.body.get(name), Box):
            continue
        box = scenario.body[name]
        thin = round(float(np.min(box.max - box.min)) / (box.dp or scenario.dp))
        if thin < needed:
            yield (
                f"{name}: a wall of {thin} layers is thinner than the kernel's reach;"
                f" make it {needed} layers ({needed * scenario.dp:.3g} m) thick"
            )


def _roughness(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[str]:
    """Roughness larger than the flow is deep: no wall law describes that."""
    depths = flow_depths(scenario, state, names)
    depth = min((across * scenario.dp for across in depths.values()), default=math.inf)
    rough = [(f"body.{name}", getattr(b, "ks", None)) for name, b in scenario.body.items()]
    rough += [(f"inflow.{name}", inflow.ks) for name, inflow in scenario.inflow.items()]
    for name, ks in rough:
        if ks is not None and ks > depth:
            yield (
                f"{name}.ks = {ks:.3g} m is larger than the depth of the flow, {depth:.3g} m: model"
                " such roughness as bodies"
            )


def _gauges(scenario: Scenario, state: State) -> Iterator[str]:
    for name in outside_everything(scenario, state):
        position = scenario.gauge[name].position.tolist()
        yield f"gauge.{name}.position = {position} m lies outside everything in the scene"


def _mach(scenario: Scenario, state: State) -> Iterator[str]:
    speed, mach = mach_number(scenario, state)
    if mach > HIGHEST_MACH * 1.05:
        yield (
            f"speeds up to {speed:.3g} m/s are Mach {mach:.2g} at xi = {scenario.xi:.3g}; for Mach"
            f" {HIGHEST_MACH} set xi = {scenario.xi * mach / HIGHEST_MACH:.2g}"
        )


def _detached(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[str]:
    """Under gravity, a free body that touches nothing falls before the flow begins."""
    if not np.any(scenario.gravity):
        return
    for body, name in names.items():
        of_it = state["body"] == body
        if (
            not np.isin(state["motion"][of_it], (FREE, BOUND)).all()
            or not of_it.any()
            or of_it.all()
        ):
            continue
        others = ~of_it & (state["motion"] != DRIVEN)
        gap = (
            _gap(state["position"][of_it], state["position"][others], 4 * scenario.dp) / scenario.dp
        )
        if gap > TOUCHING:
            told = f"{gap:.2g} dp" if np.isfinite(gap) else "more than 4 dp"
            yield (
                f"{name}: touches nothing, its nearest neighbour is {told} away;"
                " move it if it should rest"
            )


def _gap(one: np.ndarray, other: np.ndarray, reach: float) -> float:
    """Least distance between two sets of points, or inf if it is over `reach`."""
    low, high = one.min(axis=0) - reach, one.max(axis=0) + reach
    other = other[((other >= low) & (other <= high)).all(axis=1)]
    cells: dict[bytes, list[int]] = {}
    for k, cell in enumerate(np.floor(other / reach).astype(np.int64)):
        cells.setdefault(cell.tobytes(), []).append(k)
    least = np.inf
    steps = np.stack(np.meshgrid(*[(-1, 0, 1)] * one.shape[1], indexing="ij"), -1).reshape(
        -1, one.shape[1]
    )
    for x in one:
        near = [
            k
            for c in np.floor(x / reach).astype(np.int64) + steps
            for k in cells.get(c.tobytes(), ())
        ]
        if near:
            least = min(least, float(np.linalg.norm(other[near] - x, axis=1).min()))
    return least if least <= reach else np.inf
