"""Runs a scenario: drives the core from output to output and keeps the record."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .checkpoint import Checkpoint, CheckpointFolder, Position
from .core import load_core
from .errors import PhysicsError, ResourceError
from .failure import Failure, explain_failure
from .folder import RunFolder
from .gauges import GaugeReader, build_gauges
from .loading import load
from .ranks import OneRank
from .record import Recorder
from .rewind import Rewind
from .rigid_bodies import grain_table
from .scenario import Scenario
from .schedule import CheckpointClock, OutputTimes, StopRequests
from .trust import write_trust

BURST_SECONDS = 0.2  # wall time between two looks at signals and the progress bar
FIRST_BURST, LAST_BURST = 1, 1_000_000  # steps
CHECKPOINT_MINUTES = 10.0  # what a crash may cost

Progress = Callable[[float, float, int], None]  # time, timestep, step
Started = Callable[[Scenario, Any, list[str]], None]  # scenario, core simulation, body names


def _no_progress(_time: float, _timestep: float, _step: int) -> None:
    pass


def _say_nothing(_scenario: Scenario, _simulation: Any, _body_names: list[str]) -> None:
    pass


@dataclass
class RunOptions:
    """How a run is carried out, as against what it simulates."""

    threads: int | None = None
    overwrite: bool = False
    progress: Progress = field(default=_no_progress)
    started: Started = field(default=_say_nothing)  # called before the first step
    checkpoint_every: float | None = None  # s of simulated time
    checkpoint_minutes: float = CHECKPOINT_MINUTES  # of wall time
    ranks: OneRank = field(default_factory=OneRank)


def history_row(simulation: Any, material_names: list[str]) -> dict[str, float]:
    """One row of history.csv (columns and units: docs/output.md)."""
    totals = simulation.totals()
    axes = "xyz"[: len(totals["momentum"])]
    row = {"time": simulation.time, "step": simulation.steps, "dt": simulation.timestep}
    row["mass"] = totals["mass"]
    row |= {f"momentum_{axis}": p for axis, p in zip(axes, totals["momentum"], strict=True)}
    for name in "kinetic_energy bulk_energy shear_energy av_dissipation".split():
        row[name] = totals[name]
    row |= {f"mass_{name}": totals[f"mass_{name}"] for name in "asked entered left".split()}
    row["mass_inside"] = totals["mass"]
    row["mass_initial"] = totals["mass_initial"]
    row["n_particles"] = len(simulation)
    row |= {f"n_{name}": n for name, n in zip(material_names, totals["count"], strict=True)}
    return row


class ActiveRun:
    """One run in progress: the simulation, its record and where it stands in it."""

    def __init__(
        self,
        scenario: Scenario,
        simulation: Any,
        recorder: Recorder,
        body_names: list[str],
        ranks: OneRank,
    ) -> None:
        self.scenario = scenario
        self.simulation = simulation
        self.recorder = recorder
        self.body_names = body_names
        self.ranks = ranks
        self.folder = RunFolder(recorder.directory)
        self.checkpoints = CheckpointFolder(self.folder.checkpoints)
        self.position = Position()
        self.rewind = Rewind()
        self.outputs = OutputTimes(scenario.time_out, scenario.time_max)
        self.gauges = [
            (gauge, OutputTimes(gauge.interval, scenario.time_max))
            for gauge in build_gauges(scenario, body_names)
        ]
        self._started = time.perf_counter()

    @property
    def wall_seconds(self) -> float:
        """Wall time spent, parts before a resumption included."""
        return self.position.wall_seconds + time.perf_counter() - self._started

    def record_snapshot(self) -> None:
        """Write the state; the next snapshot is due one interval later."""
        simulation = self.simulation
        self.recorder.snapshot(
            simulation.state(),
            time=simulation.time,
            step=simulation.steps,
            dt=simulation.timestep,
            grains=grain_table(simulation),
        )
        self.position.outputs += 1
        self.position.snapshots += 1

    def record_history(self) -> None:
        """Write a row of diagnostics; the next one is due one interval later."""
        self.recorder.history(self.history_row())
        self.position.rows += 1
        while self.position.next_history <= self.simulation.time:
            self.position.next_history += self.scenario.time_history

    def history_row(self) -> dict[str, float]:
        """What is known of the run now."""
        row = history_row(self.simulation, self.scenario.material_names)
        return row | self.ranks.balance(self.simulation)

    def record_gauge(self, gauge: GaugeReader) -> None:
        """Write a sample."""
        rows = gauge.read(self.simulation)
        self.recorder.gauge(gauge.name, gauge.header, rows)
        written = self.position.gauge_rows.get(gauge.name, 0) + len(rows)
        self.position.gauge_rows = self.position.gauge_rows | {gauge.name: written}

    def checkpoint(self) -> Checkpoint:
        """A copy of the state and of where the run stands."""
        position = Position(**vars(self.position) | {"wall_seconds": self.wall_seconds})
        names = self.scenario.material_names, self.body_names
        return Checkpoint(self.simulation.checkpoint(), position, *names)

    def write_checkpoint(self, clock: CheckpointClock) -> None:
        """Put the state safely on the disk."""
        clock.reset(self.simulation.time)
        self.position.next_checkpoint = clock.next_time
        self.recorder.sync()
        self.store(self.checkpoint())

    def store(self, checkpoint: Checkpoint) -> None:
        """Write a copy of the state."""
        state = self.ranks.whole_checkpoint(self.simulation, checkpoint.state)
        self.ranks.on_root(lambda: self.checkpoints.write(replace(checkpoint, state=state)))

    def next_output(self) -> float:
        """Time of the next snapshot; the last one is always at time_max."""
        return self.outputs.time(self.position.outputs)

    def limit_at(self, simulated: float) -> float:
        """The limit that steps have at a simulated time: the next snapshot or sample."""
        times = [self.outputs, *(times for _, times in self.gauges)]
        limit = min(each.after(simulated) for each in times)
        return min(limit, self.scenario.time_max)

    def start(self) -> None:
        """Take the first rates; record the initial state."""
        self.simulation.start()
        self.record_snapshot()
        self.record_history()
        for gauge, _ in self.gauges:
            self.record_gauge(gauge)

    def advance(self, options: RunOptions, stop: StopRequests) -> str:
        """Steps to the end ("done"), or to the first look after a stop request ("stopped")."""
        simulation, burst = self.simulation, FIRST_BURST
        clock = CheckpointClock(
            options.checkpoint_every, options.checkpoint_minutes, self.position.next_checkpoint
        )
        stopped = False
        while simulation.time < self.scenario.time_max and not stopped:
            if self.ranks.agree(self.rewind.is_due()):
                self.rewind.keep(self.checkpoint)
            burst = self._burst(burst, clock.next_time)
            if self.ranks.agree(clock.is_due(simulation.time)):
                self.write_checkpoint(clock)
            options.progress(simulation.time, simulation.timestep, simulation.steps)
            stopped = self.ranks.agree(bool(stop))
        self.write_checkpoint(clock)
        if stopped:
            self.record_snapshot()
            self.record_history()
        return "stopped" if stopped else "done"

    def _burst(self, steps: int, pause: float) -> int:
        """Steps and records; returns how many steps to take next time."""
        simulation, limit = self.simulation, self.limit_at(self.simulation.time)
        samples = [(gauge, times.after(simulation.time)) for gauge, times in self.gauges]
        started, first = time.perf_counter(), simulation.steps
        pause = min(limit, pause, self.position.next_history)
        simulation.advance(limit=limit, pause=pause, max_steps=steps)
        rate = (simulation.steps - first) / (time.perf_counter() - started)
        if self.outputs.is_due(simulation.time, self.next_output()):
            self.record_snapshot()
        for gauge, planned in samples:
            if self.outputs.is_due(simulation.time, planned):
                self.record_gauge(gauge)
        if simulation.time >= min(self.position.next_history, self.scenario.time_max):
            self.record_history()
        return self.ranks.agree(max(1, min(LAST_BURST, int(rate * BURST_SECONDS))))

    def fail(self, message: str) -> Failure:
        """Go back to the step before the failure, record that state, and explain what happened."""
        simulation = self.simulation
        failure = Failure(
            *simulation.failure, message, simulation.state(), simulation.time, simulation.steps
        )
        failure.rewound = self.rewind.back_to(simulation, simulation.steps, self.limit_at)
        if failure.rewound:
            # The step before may be past saving; the run may go on from the state well before it.
            self.store(self.rewind.last)
            self.write_checkpoint(CheckpointClock(None, 0.0))
        self.record_snapshot()
        explain_failure(self, failure)
        return failure


def _summary(run: ActiveRun, status: str) -> dict[str, Any]:
    simulation, scenario = run.simulation, run.scenario
    last = run.history_row()
    balance = last["mass_initial"] + last["mass_entered"] - last["mass_left"] - last["mass_inside"]
    return {
        "status": status,
        "title": scenario.title,
        "scheme": scenario.scheme,
        "dim": scenario.dim,
        "precision": scenario.precision,
        "dp": scenario.dp,
        "xi": scenario.xi,
        "ranks": run.ranks.count,
        "wall_seconds": run.wall_seconds,
        "particle_updates_per_second": simulation.updates / run.wall_seconds,
        "neighbour_rebuilds": simulation.rebuilds,
        "bytes_per_particle": simulation.bytes_per_particle,
        "list_entries_per_particle": simulation.entries_per_particle,
        "ledger_residual": balance,
        "largest_overlap": simulation.grains()["worst_overlap"],
        "warnings": scenario.warnings,
        **last,
    }


def run_scenario(
    scenario: Scenario, directory: str | Path, options: RunOptions | None = None
) -> dict[str, Any]:
    """Simulates `scenario` and writes its record into `directory`.

    Returns the summary, which is also DIR/summary.json; its `status` is "done", or "stopped" after
    SIGINT, SIGTERM or a file DIR/STOP.  Raises UserError for a scenario or folder that cannot be
    used (nothing is written then), PhysicsError when the state becomes unphysical (the record up to
    there is kept, the summary says "failed"), ResourceError when memory or disk runs out.
    """
    options = options or RunOptions()
    simulation, body_names = options.ranks.filled_simulation(scenario)
    names = scenario.material_names, body_names
    text = scenario.effective_toml()
    recorder = options.ranks.recorder(
        directory,
        lambda: Recorder(directory, text, *names, scenario.dim, overwrite=options.overwrite),
    )
    run = ActiveRun(scenario, simulation, recorder, body_names, options.ranks)
    return carry_out(run, options, fresh=True)


def carry_out(run: ActiveRun, options: RunOptions, fresh: bool) -> dict[str, Any]:
    """Takes a run, `fresh` or restored, to its end; see run_scenario."""
    core, directory = load_core(), run.folder.path
    threads = run.ranks.threads(options.threads)
    if threads:
        core.set_threads(threads)
    run.ranks.working_in(directory, run.simulation)
    stop = StopRequests(directory)
    try:
        with stop.listening():
            if fresh:
                run.start()
                run.ranks.show(
                    run.simulation,
                    lambda whole: options.started(run.scenario, whole, run.body_names),
                )
            status = run.advance(options, stop)
    except core.ResourceFailure as failure:
        raise ResourceError(str(failure)) from failure
    except core.PhysicsFailure as failure:
        explained = run.fail(str(failure))
        run.recorder.close(_summary(run, "failed") | {"failure": str(failure)})
        raise PhysicsError(
            f"{failure}. {explained.advice} The record up to there is in {directory};"
            f" more: doseki explain {directory}"
        ) from failure
    except ResourceError as error:
        raise ResourceError(f"{error}; what was written before is whole, in {directory}") from None
    summary = _summary(run, status)
    run.recorder.close(summary)
    run.ranks.on_root(lambda: write_trust(load(directory)))
    return summary
