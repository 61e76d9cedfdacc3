"""Flows that `doseki bench` times when they are under way: what a user waits for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

from ..compiled import load_core
from ..scenario.load import load_scenario
from ..solver.build import build_simulation
from ..solver.protocol import CoreSimulation
from .case import clocked
from .report import machine, markdown_table

Row = dict[str, Any]

ROUNDS = 5
NO_LIMIT = 10**15  # steps


@dataclass(frozen=True)
class Flow:
    """A scenario, and from when on it is timed."""

    name: str
    scenario: str
    settings: tuple[str, ...]
    developed: float  # s of flow before the first measurement
    window: float  # s of flow that one measurement takes


DAM_BREAK = ("scheme=resolved", "tank_height=1.8")  # high enough for what splashes up
FLUME = ("scheme=resolved", "flume_length=2.2", "load_mass=5", "load_length=0.32", "load_start=1.2")

FLOWS = {
    flow.name: flow
    for flow in (
        # Past the impact on the far wall.
        Flow("dam-break-2d", "dambreak", (*DAM_BREAK, "dp=0.005"), 0.6, 0.01),
        Flow("dam-break-3d", "dambreak", (*DAM_BREAK, "dim=3", "dp=0.015"), 0.6, 0.01),
        # The water has reached the load, which goes with it.
        Flow("flume", "flume", FLUME, 0.8, 0.005),
        Flow("tumbler", str(Path(__file__).parent / "tumbler.toml"), (), 1.0, 0.005),
    )
}


def run_until(simulation: CoreSimulation, instant: float) -> None:
    """Step until this time, s."""
    simulation.advance(limit=instant, pause=instant, max_steps=NO_LIMIT)


@dataclass
class Clocked:
    """What has been measured of a flow in some precision on some threads."""

    simulation: CoreSimulation
    precision: str
    threads: int
    flow_rates: list[float] = field(default_factory=list)  # s of flow per s
    core_shares: list[float] = field(default_factory=list)  # processor time / (time x threads)
    phases: dict[str, float] = field(default_factory=dict)  # s
    seconds: float = 0.0
    steps: int = 0
    rebuilds: int = 0
    updates: int = 0
    flow_time: float = 0.0

    def run_window(self, window: float) -> None:
        """Adds one measurement."""
        simulation = self.simulation
        load_core().set_threads(self.threads)
        steps, rebuilds, updates = simulation.steps, simulation.rebuilds, simulation.updates
        start = simulation.time
        simulation.time_phases(True)
        seconds, core_share = clocked(self.threads, partial(run_until, simulation, start + window))
        for phase, spent in simulation.phase_seconds().items():
            self.phases[phase] = self.phases.get(phase, 0.0) + spent
        simulation.time_phases(False)
        self.flow_rates.append((simulation.time - start) / seconds)
        self.core_shares.append(core_share)
        self.seconds += seconds
        self.flow_time += simulation.time - start
        self.steps += simulation.steps - steps
        self.rebuilds += simulation.rebuilds - rebuilds
        self.updates += simulation.updates - updates

    def row(self, flow: Flow, alone: float | None) -> Row:
        """The result; `alone` is the rate of one thread, where it was measured."""
        simulation = self.simulation
        rate, total = median(self.flow_rates), sum(self.phases.values())
        return {
            "flow": flow.name,
            "precision": self.precision,
            "n": len(simulation),
            "threads": self.threads,
            "flow_seconds_per_second": rate,
            "spread": (max(self.flow_rates) - min(self.flow_rates)) / rate,
            "updates_per_s": self.updates / self.seconds,
            "timestep": self.flow_time / self.steps,
            "steps_per_rebuild": self.steps / max(1, self.rebuilds),
            "skin": simulation.skin,
            "bytes_per_particle": simulation.bytes_per_particle,
            "efficiency": rate / (alone * self.threads) if alone else None,
            "core_share": median(self.core_shares),
            "phases": {phase: spent / total for phase, spent in self.phases.items()},
        }


def developed(flow: Flow, precision: str, threads: int) -> CoreSimulation:
    """Its simulation, run until it is timed."""
    load_core().set_threads(threads)
    settings = (*flow.settings, f"precision={precision}")
    simulation, _names = build_simulation(load_scenario(flow.scenario, settings))
    run_until(simulation, flow.developed)
    return simulation


def time_flow(flow: Flow, precisions: Sequence[str], threads: Sequence[int]) -> list[Row]:
    """One row for each precision and number of threads. They take turns, so that all see the same
    flow and what disturbs the machine disturbs them alike.
    """
    clocks: list[Clocked] = []
    for precision in precisions:
        simulation = developed(flow, precision, max(threads))
        clocks += [Clocked(simulation, precision, count) for count in threads]
    for _ in range(ROUNDS):
        for clock in clocks:
            clock.run_window(flow.window)
    alone = {clock.precision: median(clock.flow_rates) for clock in clocks if clock.threads == 1}
    return [clock.row(flow, alone.get(clock.precision)) for clock in clocks]


def time_flows(
    names: Sequence[str], precisions: Sequence[str], threads: Sequence[int]
) -> Iterator[list[Row]]:
    """The rows of one flow after another."""
    for name in names:
        yield time_flow(FLOWS[name], precisions, threads)


def flow_table(rows: Sequence[Row]) -> str:
    """How many seconds of flow a second brings."""
    header = [
        "flow",
        "N",
        "precision",
        "threads",
        "flow s/s",
        "+-",
        "cores had",
        "efficiency",
        "M updates/s",
    ]
    header += ["step, us", "steps per list", "skin", "bytes/particle"]
    return markdown_table(
        header,
        [
            [
                row["flow"],
                str(row["n"]),
                row["precision"],
                str(row["threads"]),
                f"{row['flow_seconds_per_second']:.3g}",
                f"{50 * row['spread']:.0f} %",
                f"{100 * row['core_share']:.0f} %",
                "" if row["efficiency"] is None else f"{row['efficiency']:.2f}",
                f"{row['updates_per_s'] / 1e6:.2f}",
                f"{1e6 * row['timestep']:.3g}",
                f"{row['steps_per_rebuild']:.1f}",
                f"{row['skin']:.3g}",
                f"{row['bytes_per_particle']:.0f}",
            ]
            for row in rows
        ],
    )


def flow_phase_table(rows: Sequence[Row]) -> str:
    """Share of each phase in the time of a step, %."""
    phases = list(rows[0]["phases"])
    lines = [
        [
            row["flow"],
            row["precision"],
            str(row["threads"]),
            *(f"{100 * row['phases'][p]:.1f}" for p in phases),
        ]
        for row in rows
    ]
    return markdown_table(["flow", "precision", "threads", *phases], lines)


def print_flows(rows: Sequence[Row]) -> None:
    """Both tables, as Markdown."""
    print(f"{machine()}; scheme resolved, flows under way\n\n{flow_table(rows)}")
    print(f"\nShare of a step, %\n\n{flow_phase_table(rows)}")
