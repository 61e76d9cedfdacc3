"""States of small synthetic runs, and the scenario that they go by."""

from __future__ import annotations

import numpy as np

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
        "damage": random.uniform(0, 1, n),
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
