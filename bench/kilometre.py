#!/usr/bin/env python3
"""A valley of 1 km: makes its map and scenario, and times a stretch of a run.

../.venv/bin/python kilometre.py FOLDER [--dp 0.5] [--seconds 60] [--begin 0]

Writes FOLDER/valley.asc and FOLDER/kilometre.toml, which `doseki check` and `doseki run` take, and
steps it for so many seconds of processor time.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from pathlib import Path

import numpy as np

from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation, load_core

LENGTH, WIDTH, CELL = 1000.0, 300.0, 2.0  # m
STEEP, FLAT = 0.45, 0.08  # slope at the head and at the mouth
SCENARIO = """
schema = 1
title = "A valley of 1 km"
dim = 3
scheme = "resolved"
dp = 2.0
time_max = 45
time_out = 5
gravity = [0, 0, -9.81]
speed_max = 25

[material.debris]
based_on = "water"
rho0 = 1900
nu = 0.1

[terrain]
file = "valley.asc"
material = "basalt"
wall = "voellmy"
mu = 0.1
turbulent_xi = 300

[body.release]
shape = "release"
material = "debris"
polygon = [[40, 110], [120, 110], [120, 190], [40, 190]]
thickness = 5

[maps]
cell = 8
"""


def heights(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The valley (m): its floor becomes flatter and wider, and winds a little."""
    u = x / LENGTH
    floor = LENGTH * (STEEP * (1 - u) - 0.5 * (STEEP - FLAT) * (1 - u**2))
    across = y - 0.5 * WIDTH - 20.0 * np.sin(2 * np.pi * u)
    bank = 1.0 / (60.0 + 200.0 * u**2)
    return np.asarray(floor + 0.5 * bank * np.minimum(np.abs(across), 90.0) ** 2)


def write_case(folder: Path) -> Path:
    """The map and the scenario in a folder; returns the scenario."""
    folder.mkdir(parents=True, exist_ok=True)
    x, y = (np.arange(CELL / 2, length, CELL) for length in (LENGTH, WIDTH))
    write_raster(folder / "valley.asc", Raster(heights(*np.meshgrid(x, y))[::-1], 0.0, 0.0, CELL))
    path = folder / "kilometre.toml"
    path.write_text(SCENARIO)
    return path


def stretch(path: Path, dp: float, seconds: float, begin: float) -> dict[str, float]:
    """Steps a second of processor time, by one thread, and memory, from `begin` s of flow on."""
    load_core().set_threads(1)
    simulation, _, _ = filled_simulation(load_scenario(path, [f"dp={dp}"]))
    simulation.start()
    simulation.advance(limit=1e9, pause=begin, max_steps=10**9)
    steps, updates, started = simulation.steps, simulation.updates, time.process_time()
    while (spent := time.process_time() - started) < seconds:
        simulation.advance(limit=1e9, pause=1e9, max_steps=20)
    steps, updates = simulation.steps - steps, simulation.updates - updates
    state = simulation.state()
    walls = int((state["motion"] == 1).sum())
    return {
        "seconds": spent,
        "steps": steps,
        "time_of_flow": simulation.time,
        "timestep": simulation.timestep,
        "particles": len(simulation),
        "walls": walls,
        "updates_per_second": updates / spent,
        "bytes_per_particle": simulation.bytes_per_particle,
        "peak_memory_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2,
    }


def main() -> None:
    """Make the case and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--dp", type=float, default=2.0)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--begin", type=float, default=0.0)
    given = parser.parse_args()
    path = write_case(given.folder)
    print(json.dumps(stretch(path, given.dp, given.seconds, given.begin), indent=1))


if __name__ == "__main__":
    main()
