"""`doseki check`: what a scenario will take and what is doubtful about it, before it runs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..driver.ranks import OneRank
from ..driver.schedule import steps_between
from ..driver.start.first_state import first_state
from ..errors import PhysicsError, ResourceError
from ..record.particles import FIXED
from ..record.units import unit_in
from ..scenario.model import Scenario
from ..scenario.tables.bodies import Box
from ..scene.inflow_sections import build_inflows, to_enter
from ..solver.build import load_core
from ..solver.protocol import SimulationView
from ..util.finding import Finding, rounded_up, sentences
from ..util.memory import available_bytes
from ..util.telling import Tell, say_nothing
from .cost import Estimate, estimate
from .estimates import (
    flow_depths,
    grain_spacings,
    mach_number,
    solid_steps_text,
    solid_timestep,
    step_ends,
)
from .ground.sliding import Sliding
from .ground.volumes import volume_lines, volumes_at_start
from .summary import duration_text
from .warnings import findings, thorough_findings

TOLD_SAMPLING = 0.1  # of the wall time; more is told of
WIDTH = 18


@dataclass(frozen=True)
class Preflight:
    """What a scenario will take, and what is doubtful about it; str() is the report on it."""

    text: str
    warnings: list[str]  # one sentence each, with the remedy
    particles: int  # at the start
    memory: float  # bytes
    disk: float  # bytes
    timestep: float  # s
    steps: float
    seconds: float  # of wall time

    def __str__(self) -> str:
        return self.text


def check_scenario(scenario: Scenario, threads: int | None = None, tell: Tell = say_nothing) -> str:
    """The report of `doseki check`; raises UserError or PhysicsError for what cannot start."""
    return str(preflight(scenario, threads, tell))


def preflight(
    scenario: Scenario, threads: int | None = None, tell: Tell = say_nothing
) -> Preflight:
    """Begin as a run does, and take a burst of steps of a second; raises as check_scenario does."""
    core = load_core()
    before = core.threads()
    core.set_threads(threads or before)
    try:
        simulation, body_names, warnings, goes_on = first_state(scenario, OneRank(), tell)
        if not goes_on:
            simulation.start()
        state = simulation.state()
        sliding = Sliding(scenario, state, body_names)
        expected = estimate(scenario, simulation, body_names, sliding)
    except core.ResourceFailure as failure:
        raise ResourceError(str(failure)) from failure
    except core.PhysicsFailure as failure:
        raise PhysicsError(f"the first steps already fail: {failure}") from failure
    finally:
        core.set_threads(before)
    lines = [scenario.title or "scenario", ""]
    lines += [*_particles(scenario, state, body_names), *_costs(scenario, expected)]
    lines += [*_resolution(scenario, state, body_names)]
    doubts = sentences(thorough_findings(sliding, warnings))
    lines += ["", *(f"warning: {doubt}" for doubt in doubts)] if doubts else ["", "no warnings"]
    return Preflight(
        "\n".join(lines), doubts, len(state["id"]), expected.memory, expected.disk,
        expected.timestep, expected.steps, expected.seconds,
    )  # fmt: skip


def brief_check(
    scenario: Scenario,
    simulation: SimulationView,
    body_names: list[str],
    doubts: Sequence[str] = (),
) -> list[str]:
    """A few lines about a simulation that has just been started, with its `brief_doubts`."""
    dt = simulation.rates()["timestep"]
    memory = len(simulation) * simulation.bytes_per_particle
    steps = steps_between(scenario.begins_at, scenario.time_max, dt, step_ends(scenario))
    # Where nothing limits a step, the next output or the end does.
    first = min(dt, *step_ends(scenario), scenario.time_max - scenario.begins_at)
    head = (
        f"{len(simulation):,} particles, {_size(memory)}, first timestep {first:.3g} s: about"
        f" {steps:,.0f} steps"
    )
    names = dict.fromkeys(_copied(name) for name in body_names)
    sizes = [f"{name}: {size}" for name in names for size in _resized(scenario, name)]
    return [head, *sizes, *(f"warning: {doubt}" for doubt in doubts)]


def brief_doubts(
    scenario: Scenario,
    simulation: SimulationView,
    body_names: list[str],
    warnings: Sequence[Finding] = (),
) -> list[str]:
    """What is doubtful about a simulation that has just been started, a sentence each.

    It costs well under a second.  `warnings` are those that came up when the scene was built.
    """
    return sentences(findings(scenario, simulation.state(), body_names, warnings))


def _line(name: str, text: str) -> str:
    return f"{name:<{WIDTH}}{text}"


def _particles(scenario: Scenario, state: dict[str, np.ndarray], names: list[str]) -> Iterator[str]:
    fixed = int(np.sum(state["motion"] == FIXED))
    yield _line("particles", f"{len(state['id']):,} at the start, {fixed:,} of them fixed")
    counts: dict[tuple[str, str], list[int]] = {}
    for body, name in enumerate(names):
        count = int(np.sum(state["body"] == body))
        if count:
            material = scenario.material_names[state["material"][state["body"] == body][0]]
            counts.setdefault((_copied(name), material), []).append(count)
    volumes = volume_lines(volumes_at_start(scenario, state, names).table, scenario.dim)
    for (name, material), each in counts.items():
        copies = f" in {len(each)} copies" if len(each) > 1 else ""
        yield _line(f"  {name}", f"{sum(each):,} {material}{copies}")
        yield from (_line("", size) for size in _resized(scenario, name))
        if name in volumes:
            yield _line("", volumes[name])
    unit = unit_in("m3", scenario.dim)
    for section in build_inflows(scenario, names):
        volume, most = to_enter(scenario, section)
        material = scenario.material_names[section.material]
        yield _line(
            f"inflow {section.name}",
            f"{volume:.4g} {unit} {material} to enter, {most:.4g} {unit}/s at most",
        )


def _copied(name: str) -> str:
    """The name of a body without its number among copies."""
    stem, _, number = name.rpartition(".")
    return stem if number.isdigit() else name


def _resized(scenario: Scenario, name: str) -> Iterator[str]:
    """The size that a box of particles got, where dp does not divide it."""
    table = scenario.body.get(_first(scenario, name))
    if not isinstance(table, Box) or scenario.kinematics_of(_first(scenario, name)).is_whole:
        return
    given, got = table.max - table.min, table.filled_size(scenario.dp)
    if np.any(np.abs(got - given) > 1e-6 * (table.dp or scenario.dp)):
        shown = [" x ".join(f"{x:.4g}" for x in size) for size in (got, given)]
        spacing = table.dp or scenario.dp
        yield f"{shown[0]} m: dp = {spacing:g} m does not divide {shown[1]} m"


def _first(scenario: Scenario, name: str) -> str:
    """A body, or the first of its copies."""
    return name if name in scenario.body else f"{name}.1"


def _costs(scenario: Scenario, expected: Estimate) -> Iterator[str]:
    yield _line("most particles", _most_text(expected))
    if math.isnan(expected.memory):
        yield _line("steps", f"{expected.steps:,.0f} or more")
        yield _line("cost", "not known: nothing has entered within a burst of a second")
        return
    free = available_bytes()
    yield _line("memory", f"{_size(expected.memory)} of {_size(free)} free")
    yield _line("state", f"{_size(expected.state)} of it, which steps work on")
    yield _line("disk", _size(expected.disk))
    yield _line("timestep", f"{expected.timestep:.3g} s")
    outputs = f", {expected.shortened:,.0f} of them because outputs end steps"
    shown = outputs if expected.shortened >= 1 else ""
    yield _line("steps", f"{expected.steps:,.0f}{shown}")
    yield from _solid_steps(scenario, expected)
    yield _line("updates", f"{expected.updates:.2g} of particles")
    gauges = ""
    if expected.sampling > TOLD_SAMPLING * expected.seconds:
        gauges = f"; {duration_text(expected.sampling)} of it to read gauges"
    yield _line("wall time", f"{duration_text(expected.seconds)}, from a burst of a second{gauges}")
    if scenario.relax is not None:
        steps = scenario.relax / expected.timestep
        each = (expected.seconds - expected.sampling) / expected.steps
        took = f"about {steps:,.0f} steps, {duration_text(steps * each)}"
        yield _line("before it", f"{took}, for the {scenario.relax:g} s in which water relaxes")


def _solid_steps(scenario: Scenario, expected: Estimate) -> Iterator[str]:
    """Those of bodies that deform, where they are shorter than those of the run."""
    solid = solid_timestep(scenario)
    if solid is not None and solid < expected.timestep:
        yield _line("", solid_steps_text(solid, scenario.time_max - scenario.begins_at))


def _most_text(expected: Estimate) -> str:
    if not expected.scattered:
        return f"{expected.most_particles:,.0f}, if nothing leaves"
    most = expected.most_particles
    scattered = most - expected.ground + expected.scattered
    said = f"about {rounded_up(most):,.0f}, if nothing leaves: ground comes where the flow spreads"
    if rounded_up(scattered) == rounded_up(most):
        return said
    return f"{said}, up to {rounded_up(scattered):,.0f} in all where particles scatter"


def _resolution(
    scenario: Scenario, state: dict[str, np.ndarray], names: list[str]
) -> Iterator[str]:
    across = grain_spacings(scenario)
    if across is not None:
        yield _line("per grain", f"{across:.3g} particles across")
    for name, depth in flow_depths(scenario, state, dict(enumerate(names))).items():
        yield _line(f"depth of {name}"[: WIDTH - 1], f"{depth:.3g} particles")
    if (found := mach_number(scenario, state)) is not None:
        speed, mach = found
        yield _line("Mach number", f"{mach:.2g} at up to {speed:.3g} m/s, xi = {scenario.xi:.4g}")


def _size(size: float) -> str:
    for unit in ("B", "kB", "MB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} GB"
