"""Small synthetic runs to record, load and draw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.record import Recorder

MATERIALS = ("water", "basalt", "aluminium")
BODIES = ("sea", "grain", "bed")
SCENARIO = """\
schema = 1
title = "synthetic"
dim = {dim}
dp = 0.1
time_max = 2.0
time_out = 1.0
"""


def random_state(n: int, dim: int, seed: int = 1) -> dict[str, np.ndarray]:
    """Every field with random contents: n particles in `dim` dimensions."""
    random = np.random.default_rng(seed)
    tensor = random.normal(size=(2, n, 3, 3))
    tensor = tensor + tensor.transpose(0, 1, 3, 2)
    state = {name: random.normal(size=(n, dim)) for name in ("position", "velocity")}
    for name in ("density", "pressure", "mass", "smoothing_length", "sound_speed"):
        state[name] = random.uniform(0.1, 0.2, n)
    for name in ("material", "body", "motion"):
        state[name] = random.integers(0, 3, n).astype(np.int32)
    return state | {"stress": tensor[0], "deviatoric_stress": tensor[1], "id": np.arange(n) * 7}


def record_random_run(directory: Path, dim: int = 2, times: tuple[float, ...] = (0.0, 1.0, 2.0)):
    """A run of random states; returns the recorder, still open, and the states."""
    recorder = Recorder(directory, SCENARIO.format(dim=dim), MATERIALS, BODIES, dim)
    states = [random_state(20, dim, seed) for seed in range(len(times))]
    for step, (time, state) in enumerate(zip(times, states, strict=True)):
        recorder.snapshot(state, time=time, step=step, dt=0.1)
        recorder.history({"time": time, "step": step, "kinetic_energy": 1.0 / 3.0 + time})
    return recorder, states


@pytest.fixture
def run_folder(tmp_path: Path) -> Path:
    """The folder of a finished 2-D run of three random snapshots at 0, 1 and 2 s."""
    recorder, _ = record_random_run(tmp_path / "run")
    recorder.close({"steps": 2})
    return tmp_path / "run"
