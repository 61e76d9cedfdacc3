"""Runs a scenario: drives the core from output to output and keeps the record."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .core import build_simulation, load_core
from .errors import PhysicsError, ResourceError
from .record import Recorder
from .scenario import Scenario

BURST_SECONDS = 0.2  # wall time between two looks at signals and the progress bar
FIRST_BURST, LAST_BURST = 1, 1_000_000  # steps
HISTORY_ROWS = 1000  # rows of history.csv when the scenario does not ask for an interval

Progress = Callable[[float, float, int], None]  # time, timestep, step


def _no_progress(_time: float, _timestep: float, _step: int) -> None:
    pass


@dataclass
class RunOptions:
    """How a run is carried out, as against what it simulates."""

    threads: int | None = None
    overwrite: bool = False
    progress: Progress = field(default=_no_progress)


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


@contextmanager
def _stop_requests() -> Iterator[list[int]]:
    """Collects SIGINT and SIGTERM, so that a run can end at a whole step with its record closed."""
    received: list[int] = []
    numbers = (signal.SIGINT, signal.SIGTERM)
    try:
        old = {n: signal.signal(n, lambda number, _frame: received.append(number)) for n in numbers}
    except ValueError:  # not the main thread: whoever started it handles signals
        yield received
        return
    try:
        yield received
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)


class _Run:
    """One run in progress: the simulation, its record and the clock of outputs."""

    def __init__(self, scenario: Scenario, simulation: Any, recorder: Recorder) -> None:
        self.scenario = scenario
        self.simulation = simulation
        self.recorder = recorder
        self.history_interval = scenario.time_history or scenario.time_max / HISTORY_ROWS
        self.next_history = 0.0
        self.outputs = 0

    def record_snapshot(self) -> None:
        simulation = self.simulation
        self.recorder.snapshot(
            simulation.state(), time=simulation.time, step=simulation.steps, dt=simulation.timestep
        )
        self.outputs += 1

    def record_history(self) -> None:
        self.recorder.history(history_row(self.simulation, self.scenario.material_names))
        while self.next_history <= self.simulation.time:
            self.next_history += self.history_interval

    def next_output(self) -> float:
        """Time of the next snapshot; the last one is always at time_max."""
        scenario = self.scenario
        planned = self.outputs * scenario.time_out
        return scenario.time_max if planned > scenario.time_max * (1 - 1e-9) else planned

    def advance(self, options: RunOptions, stop: list[int]) -> None:
        """Steps to the end, or to the first step after a stop request."""
        simulation, burst = self.simulation, FIRST_BURST
        self.record_snapshot()
        self.record_history()
        while simulation.time < self.scenario.time_max and not stop:
            limit = self.next_output()
            started, first = time.perf_counter(), simulation.steps
            simulation.advance(limit=limit, pause=min(limit, self.next_history), max_steps=burst)
            rate = (simulation.steps - first) / (time.perf_counter() - started)
            burst = max(1, min(LAST_BURST, int(rate * BURST_SECONDS)))
            if simulation.time >= limit:
                self.record_snapshot()
            if simulation.time >= self.next_history or simulation.time >= self.scenario.time_max:
                self.record_history()
            options.progress(simulation.time, simulation.timestep, simulation.steps)
        if stop:
            self.record_snapshot()
            self.record_history()


def _summary(run: _Run, status: str, wall_seconds: float) -> dict[str, Any]:
    simulation, scenario = run.simulation, run.scenario
    last = history_row(simulation, scenario.material_names)
    balance = last["mass_initial"] + last["mass_entered"] - last["mass_left"] - last["mass_inside"]
    return {
        "status": status,
        "title": scenario.title,
        "scheme": scenario.scheme,
        "dim": scenario.dim,
        "precision": scenario.precision,
        "dp": scenario.dp,
        "xi": scenario.xi,
        "wall_seconds": wall_seconds,
        "particle_updates_per_second": simulation.updates / wall_seconds,
        "neighbour_rebuilds": simulation.rebuilds,
        "bytes_per_particle": simulation.bytes_per_particle,
        "list_entries_per_particle": simulation.entries_per_particle,
        "ledger_residual": balance,
        "warnings": scenario.warnings,
        **last,
    }


def run_scenario(
    scenario: Scenario, directory: str | Path, options: RunOptions | None = None
) -> dict[str, Any]:
    """Simulates `scenario` and writes its record into `directory`.

    Returns the summary, which is also DIR/summary.json; its `status` is "done", or "stopped" after
    SIGINT or SIGTERM.  Raises UserError for a scenario or folder that cannot be used (nothing is
    written then), PhysicsError when the state becomes unphysical (the record up to there is kept,
    the summary says "failed"), ResourceError when memory or disk runs out.
    """
    options = options or RunOptions()
    core = load_core()
    if options.threads:
        core.set_threads(options.threads)
    try:
        simulation, body_names = build_simulation(scenario)
    except core.ResourceFailure as failure:
        raise ResourceError(str(failure)) from failure
    except core.PhysicsFailure as failure:
        raise PhysicsError(f"the initial state cannot be stepped: {failure}") from failure
    recorder = Recorder(
        directory,
        scenario.effective_toml(),
        scenario.material_names,
        body_names,
        scenario.dim,
        overwrite=options.overwrite,
    )
    run = _Run(scenario, simulation, recorder)
    started = time.perf_counter()
    try:
        with _stop_requests() as stop:
            run.advance(options, stop)
    except core.PhysicsFailure as failure:
        run.record_snapshot()
        recorder.close(_summary(run, "failed", time.perf_counter() - started) | {"failure": str(failure)})
        raise PhysicsError(
            f"{failure}; the record up to there is in {directory}. Try a smaller cflnumber, a larger"
            " xi, or bodies that do not overlap"
        ) from failure
    summary = _summary(run, "stopped" if stop else "done", time.perf_counter() - started)
    recorder.close(summary)
    return summary
