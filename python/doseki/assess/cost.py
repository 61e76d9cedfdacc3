"""What a run will take: particles, memory, disk, steps and wall time, from a short burst."""

from __future__ import annotations

import math
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..driver.schedule import OutputTimes, steps_between
from ..record.snapshot_writer import SnapshotWriter
from ..record.vtkhdf import Header
from ..scenario.model import Scenario
from ..scene.inflow_sections import InflowSection, build_inflows
from ..solver.protocol import Simulation
from .estimates import step_ends
from .ground.sliding import Sliding
from .ground.spreading import ground_to_come
from .sampling import sampling_seconds

BURST_SECONDS = 1.0  # of wall time
HISTORY_BYTES = 430  # a row
SAMPLE_BYTES = 60  # of a gauge; a profile has as many at each of its heights
CHECKPOINT_SECONDS = 600.0  # between two, of which the last two are kept
PROCESS_BYTES = 100e6  # Python, numpy, scipy and the core themselves


@dataclass
class Estimate:
    """What a run takes, SI units and bytes."""

    particles: int  # at the start
    most_particles: float
    ground: float  # of them, wall particles that come where the flow spreads over a terrain
    scattered: float  # of the same, at most
    state: float  # of the memory, what the steps work on
    memory: float
    disk: float
    updates: float  # of particles, in all steps
    steps: float
    shortened: float  # of the steps, those that are there because outputs end steps
    seconds: float
    sampling: float  # of the seconds, those that reading gauges takes
    timestep: float


def estimate(
    scenario: Scenario,
    simulation: Simulation,
    body_names: list[str],
    sliding: Sliding | None = None,
) -> Estimate:
    """Measure on a started `simulation`, which is stepped, and extrapolate to time_max.

    Where nothing has entered a dry scene by then, what particles take is nan.  `sliding` is where
    its fluid may get to, if that is needed elsewhere, too.
    """
    start, before = len(simulation), simulation.steps
    sliding = sliding or Sliding(scenario, simulation.state(), body_names)
    mean, most, ground, scattered = _particles(sliding, start)
    rate, timestep = _burst(simulation, scenario)
    done, now, end = simulation.steps - before, simulation.time, scenario.time_max
    steps = done + steps_between(now, end, timestep, step_ends(scenario))
    unhindered = done + steps_between(now, end, timestep, ())
    if not len(simulation):
        unknown = (math.nan,) * 4
        counts = start, most, ground, scattered
        return Estimate(*counts, *unknown, steps, steps - unhindered, *unknown[:2], timestep)
    snapshot_bytes, snapshot_seconds = _snapshot(scenario, simulation, body_names)
    per_particle = simulation.bytes_per_particle
    length = scenario.time_max - scenario.begins_at
    snapshots = length / scenario.time_out + 1
    checkpoint = sum(array.nbytes for array in simulation.checkpoint().values()) / len(simulation)
    rows = min(length / scenario.time_history, steps) + 1
    samples = sum(length / interval + 1 for interval in scenario.sampled_intervals[1:])
    sampling = sampling_seconds(scenario, simulation, body_names, steps)
    seconds = steps * mean / rate + snapshots * mean * snapshot_seconds + sampling
    checkpoints = 1 if seconds < CHECKPOINT_SECONDS else 2
    return Estimate(
        particles=start,
        most_particles=most,
        ground=ground,
        scattered=scattered,
        state=most * per_particle,
        # Beside the state, a copy of it for failures, one to be written, and the image of a file.
        memory=PROCESS_BYTES + most * (per_particle + 3 * checkpoint),
        disk=snapshots * snapshot_bytes * mean
        + rows * HISTORY_BYTES
        + samples * SAMPLE_BYTES
        + checkpoints * most * checkpoint,
        updates=steps * mean,
        steps=steps,
        shortened=steps - unhindered,
        seconds=seconds,
        sampling=sampling,
        timestep=timestep,
    )


def _burst(simulation: Simulation, scenario: Scenario) -> tuple[float, float]:
    """Particle updates per second, and the timestep, over the second half of a burst.

    Outputs end steps of bodies alone, which nothing else may.
    """
    steps, time_max, first = 1, scenario.time_max, simulation.steps
    intervals = step_ends(scenario) if scenario.has_bodies_alone else [time_max]
    ends = [OutputTimes(interval, time_max) for interval in intervals]
    started = time.perf_counter()
    middle = (started, simulation.updates, simulation.steps, simulation.time)
    while (now := time.perf_counter()) - started < BURST_SECONDS and simulation.time < time_max:
        if now - started < 0.5 * BURST_SECONDS:
            middle = (now, simulation.updates, simulation.steps, simulation.time)
        limit = min(end.after(simulation.time) for end in ends)
        simulation.advance(limit=limit, pause=limit, max_steps=steps)
        steps = min(2 * steps, max(1, int(0.1 * (simulation.steps - first))))
    elapsed = time.perf_counter() - middle[0]
    steps = max(1, simulation.steps - middle[2])
    return (simulation.updates - middle[1]) / elapsed, (simulation.time - middle[3]) / steps


def _particles(sliding: Sliding, start: int) -> tuple[float, float, float, float]:
    """Mean and largest number of particles, if nothing leaves; new ground in that, and at most.

    `start` are there at first.
    """
    scenario = sliding.scenario
    times = np.linspace(scenario.begins_at, scenario.time_max, 1001)
    entered = np.zeros(len(times))
    for section in build_inflows(scenario, sliding.names):
        entered += _entered(section, times)
    ground, scattered = np.zeros(len(times)), 0.0
    if scenario.bed is not None:
        ground, scattered = ground_to_come(sliding, times, entered)
    more = entered + ground
    return start + float(more.mean()), start + float(more.max()), float(ground.max()), scattered


def _entered(section: InflowSection, times: np.ndarray) -> np.ndarray:
    """Particles (n,) that have come in between the first of the times, s, and each."""
    each = np.diff(section.entered(times), prepend=section.entered(times[:1]))
    if len(section.thickness):  # a surge, whose layers are as high as it is thick
        thick = np.interp(times, section.times, section.thickness)
        each *= (section.row_height[:, None] <= thick).mean(axis=0)
    return np.asarray(np.cumsum(each))


def _snapshot(
    scenario: Scenario, simulation: Simulation, body_names: list[str]
) -> tuple[float, float]:
    """Bytes and seconds that a snapshot takes for each particle."""
    header = Header(
        simulation.time,
        simulation.steps,
        simulation.timestep,
        scenario.dim,
        tuple(scenario.material_names),
        tuple(body_names),
    )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "snapshot"
        started = time.perf_counter()
        SnapshotWriter().write(file, simulation.state(), header)
        seconds = time.perf_counter() - started
        return file.stat().st_size / len(simulation), seconds / len(simulation)
