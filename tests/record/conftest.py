"""Small synthetic runs to record, load, measure and draw."""

from __future__ import annotations

from collections.abc import Callable
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
gravity = [-1.0, {zeros}-9.0]
"""
FLOW_TABLES = """
[window.end]
min = [0.0, -0.1]
max = [1.0, 0.3]

[figure.before]
kind = "snapshot"
window = "end"
when = "before_flow"
colour = ["material", "velocity_x"]

[figure.speeds]
kind = "histogram"
window = "end"
material = "basalt"
when = "with_flow"

[figure.energies]
kind = "series"
columns = ["kinetic_energy"]
"""

State = dict[str, np.ndarray]


def random_state(n: int, dim: int, seed: int = 1) -> State:
    """Every field with random contents: n particles in `dim` dimensions."""
    random = np.random.default_rng(seed)
    tensor = random.normal(size=(2, n, 3, 3))
    tensor = tensor + tensor.transpose(0, 1, 3, 2)
    state = {name: random.normal(size=(n, dim)) for name in ("position", "velocity")}
    for name in ("density", "pressure", "mass", "smoothing_length", "sound_speed"):
        state[name] = random.uniform(0.1, 0.2, n)
    for name in ("material", "body", "motion"):
        state[name] = random.integers(0, 3, n).astype(np.int32)
    return state | {
        "stress": tensor[0],
        "deviatoric_stress": tensor[1],
        "id": np.arange(n) * 7,
        "grain": np.full(n, -1),
    }


def make_plain_state(position: np.ndarray, velocity: np.ndarray, kind: np.ndarray) -> State:
    """Particles of 1 kg in a square of 0.1 m; kind 0 is water, 1 basalt, 2 a fixed bed."""
    n, dim = position.shape
    zeros = np.zeros((n, 3, 3))
    return {
        "position": position,
        "velocity": velocity,
        "mass": np.ones(n),
        "density": np.full(n, 1 / 0.1**dim),
        "pressure": np.zeros(n),
        "smoothing_length": np.full(n, 0.12),
        "stress": zeros,
        "deviatoric_stress": zeros,
        "sound_speed": np.full(n, 10.0),
        "material": kind.astype(np.int32),
        "body": kind.astype(np.int32),
        "motion": np.where(kind == 2, 1, 0).astype(np.int32),
        "id": np.arange(n),
        "grain": np.full(n, -1),
    }


def flow_state(time: float) -> State:
    """Water from x = 3 m that runs down to x = 3 - t m, three grains at -0.5 m/s, a bed."""
    water = np.arange(3.0 - time, 3.0 + 1e-9, 0.05)
    grains = np.array([0.2, 0.5, 0.8]) - 0.5 * time
    bed = np.arange(-1.0, 4.0, 0.1)
    x = np.concatenate([water, grains, bed])
    kind = np.repeat([0, 1, 2], [len(water), len(grains), len(bed)])
    position = np.stack([x, np.array([0.15, 0.05, -0.05])[kind]], axis=1)
    velocity = np.stack([np.array([-1.0, -0.5, 0.0])[kind], np.zeros(len(x))], axis=1)
    state = make_plain_state(position, velocity, kind)
    names = {0: 1000, 1: 100, 2: 200}
    state["id"] = np.concatenate([names[k] + np.arange(np.sum(kind == k)) for k in (0, 1, 2)])
    return state


def history_row(time: float) -> dict[str, float]:
    """Columns that the general figures and the summary use."""
    return {
        "time": time,
        "step": int(10 * time),
        "dt": 0.1,
        "kinetic_energy": 1.0 / 3.0 + time,
        "bulk_energy": time,
        "shear_energy": 0.0,
        "av_dissipation": 2 * time,
        "mass_asked": time,
        "mass_entered": time,
        "mass_left": 0.0,
        "mass_inside": 5.0 + time,
        "mass_initial": 5.0,
    }


RecordRun = Callable[..., tuple[Recorder, list[State]]]


@pytest.fixture
def record_run() -> RecordRun:
    """A function that records given states at given times; the recorder is still open."""

    def record(
        directory: Path,
        dim: int = 2,
        times: tuple[float, ...] = (0.0, 1.0, 2.0),
        state_at: Callable[[float], State] | None = None,
        tables: str = "",
    ) -> tuple[Recorder, list[State]]:
        text = SCENARIO.format(dim=dim, zeros="0.0, " * (dim - 2)) + tables
        recorder = Recorder(directory, text, MATERIALS, BODIES, dim)
        states = []
        for time in times:
            seed = int(100 * time)
            states.append(state_at(time) if state_at else random_state(20, dim, seed))
            recorder.snapshot(states[-1], time=time, step=int(10 * time), dt=0.1)
            recorder.history(history_row(time))
        return recorder, states

    return record


@pytest.fixture
def plain_state() -> Callable[..., State]:
    """The function make_plain_state."""
    return make_plain_state


@pytest.fixture
def run_folder(tmp_path: Path, record_run: RecordRun) -> Path:
    """The folder of a finished 2-D run of three random snapshots at 0, 1 and 2 s."""
    recorder, _ = record_run(tmp_path / "run")
    recorder.close({"status": "done"})
    return tmp_path / "run"


@pytest.fixture
def flow_folder(tmp_path: Path, record_run: RecordRun) -> Path:
    """The folder of a finished run of flow_state, 0 to 3 s, with a window and figures."""
    times = tuple(np.arange(0.0, 3.01, 0.25))
    recorder, _ = record_run(
        tmp_path / "flow", times=times, state_at=flow_state, tables=FLOW_TABLES
    )
    recorder.close(
        {"status": "done", "wall_seconds": 75.0, "bytes_per_particle": 400.0, "warnings": ["thin"]}
        | history_row(3.0)
    )
    return tmp_path / "flow"


@pytest.fixture
def two_grains(tmp_path: Path, record_run: RecordRun) -> Path:
    """The folder of a run of two grains that approach, without fluid."""

    def state(time: float) -> State:
        position = np.array([[-1.0, 0.0], [1.0 - 0.5 * time, 0.0]])
        velocity = np.array([[0.0, 0.0], [-0.5, 0.0]])
        return make_plain_state(position, velocity, np.array([1, 1]))

    tables = '\n[figure.pair]\nkind = "snapshot"\ntimes = [0.0, 2.0]\ncolour = ["velocity_x"]\n'
    recorder, _ = record_run(tmp_path / "pair", state_at=state, tables=tables)
    recorder.close({})
    return tmp_path / "pair"
