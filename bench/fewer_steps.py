#!/usr/bin/env python3
"""What the options that save steps or list builds change, against the plain run.

../.venv/bin/python fewer_steps.py [collision|flume ...]
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from doseki.bench.report import markdown_table
from doseki.errors import DosekiError
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, load_core

SHORT_FLUME = [
    "flume_length=1.5",
    "load_start=0.6",
    "load_length=0.3",
    "load_mass=5",
    "time_max=0.8",
]
CASES = {
    "collision of particles": ("collision", []),
    "collision of bodies": ("collision", ["particles_per_grain=793"]),
    "flume": ("flume", SHORT_FLUME),
    "flume with strength": ("flume-strength", SHORT_FLUME),
}
# The first is the plain run; the second differs from it in rounding only.
VARIANTS = {
    "plain": [],
    "skin 0.1 (rounding)": ["skin=0.1"],
    "skin auto": ["skin=auto"],
    "fixed_limits_dt = false": ["fixed_limits_dt=false"],
    "cflnumber 0.2": ["cflnumber=0.2"],
    "cflnumber 0.3": ["cflnumber=0.3"],
    "cflnumber 0.4": ["cflnumber=0.4"],
    "cflnumber 0.5": ["cflnumber=0.5"],
    "0.2, fixed_limits_dt = false": ["cflnumber=0.2", "fixed_limits_dt=false"],
    "0.3, fixed_limits_dt = false": ["cflnumber=0.3", "fixed_limits_dt=false"],
}


@dataclass
class Outcome:
    """A run from start to end, without a record."""

    steps: int
    rebuilds: int
    seconds: float
    state: dict[str, np.ndarray]
    bodies: list[str]
    energy_drift: float

    def moving(self) -> list[str]:
        """Bodies that have particles which can move."""
        free = self.state["motion"] == 0
        return [
            name for k, name in enumerate(self.bodies) if (free & (self.state["body"] == k)).any()
        ]

    def mean(self, field: str, body: str) -> float:
        """Mean of the component along x over the particles of a body that can move."""
        chosen = (self.state["motion"] == 0) & (self.state["body"] == self.bodies.index(body))
        return float(self.state[field][chosen, 0].mean())

    def fastest(self) -> float:
        """Largest speed, m/s."""
        return float(np.linalg.norm(self.state["velocity"], axis=1).max())


def _energy(simulation: Any) -> float:
    names = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")
    totals = simulation.totals()
    return sum(totals[name] for name in names)


def run(scenario_name: str, settings: list[str]) -> Outcome:
    """Runs a scenario to its end; the energy drifts where nothing enters, leaves or falls."""
    scenario = load_scenario(scenario_name, settings)
    simulation, bodies = build_simulation(scenario)
    start, began = _energy(simulation), time.process_time()
    simulation.advance(limit=scenario.time_max, pause=scenario.time_max, max_steps=10**9)
    seconds = time.process_time() - began
    drift = _energy(simulation) / start - 1 if start > 1e-9 else float("nan")
    steps, rebuilds = simulation.steps, simulation.rebuilds
    return Outcome(steps, rebuilds, seconds, simulation.state(), bodies, drift)


def line(name: str, outcome: Outcome, plain: Outcome) -> list[str]:
    """One line of the table: cost, and differences from the plain run."""
    changes = [
        f"{outcome.mean(field, body) - plain.mean(field, body):+.1e}"
        for body in plain.moving()
        for field in ("position", "velocity")
    ]
    return [
        name, str(outcome.steps), str(outcome.rebuilds), f"{outcome.seconds:.2f}", *changes,
        f"{outcome.fastest():.3f}", f"{outcome.energy_drift:+.1e}",
    ]  # fmt: skip


def table(scenario_name: str, settings: list[str]) -> str:
    """All variants of one case."""
    plain, lines = None, []
    for name, changes in VARIANTS.items():
        try:
            outcome = run(scenario_name, [*settings, *changes])
        except (DosekiError, load_core().PhysicsFailure) as error:
            lines.append([name, "fails:", *str(error).split(":")[0].split()[-1:]])
            continue
        plain = plain or outcome
        lines.append(line(name, outcome, plain))
    changes = [f"{body} {what}" for body in plain.moving() for what in ("x, m", "v_x, m/s")]
    header = ["variant", "steps", "lists", "s", *changes, "fastest, m/s", "energy drift"]
    return markdown_table(header, [entry + [""] * (len(header) - len(entry)) for entry in lines])


def main() -> None:
    """Prints one table for each case that is asked for; one thread."""
    load_core().set_threads(1)
    wanted = sys.argv[1:] or list(CASES)
    for name in CASES:
        if any(name.startswith(word) for word in wanted):
            print(f"\n{name}\n\n{table(*CASES[name])}", flush=True)


if __name__ == "__main__":
    main()
