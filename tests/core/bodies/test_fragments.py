"""Deformable bodies that come apart: their parts are bodies with surfaces of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

TOP = """
schema = 1
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 2
time_max = 1
time_out = 1
gravity = [0, 0]
friction = {friction}

[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 90
young_modulus = 1e7
poisson_ratio = 0.3
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 1e4
"""
DISC = """
[body.a]
shape = "disc"
material = "rubber"
kinematics = "elastic"
centre = [0, 0]
radius = 0.05
velocity = [{u}, {v}]
rotate = {angle}
"""
BAR = """
[body.a]
shape = "box"
material = "rubber"
kinematics = "elastic"
min = [-0.05, -0.02]
max = [0.05, 0.02]
velocity = [{u}, {v}]
"""


@pytest.fixture
def build(tmp_path: Path):
    """Makes a simulation of a body "a" that may break, but is strong."""

    def make(tables: str, friction: float = 0.0, u: float = 0.0, v: float = 0.0, angle: float = 0):
        path = tmp_path / "case.toml"
        text = TOP.format(friction=friction) + tables.format(u=u, v=v, angle=angle)
        path.write_text(text, encoding="utf-8")
        return build_simulation(load_scenario(str(path)))[0]

    return make


def cut(simulation, label) -> None:
    """By a label for each particle's position."""
    position = simulation.state()["position"]
    core = getattr(simulation, "_core", simulation)
    core.cut_bodies(np.ascontiguousarray(label(position), np.int32))


def steps(simulation, count: int) -> None:
    simulation.advance(limit=1.0, pause=1.0, max_steps=count)


def sums(simulation) -> dict[str, float | np.ndarray]:
    """Of the particles."""
    state = simulation.state()
    x, v, m = (state[key] for key in ("position", "velocity", "mass"))
    return {
        "mass": m.sum(),
        "momentum": m @ v,
        "turning": float(m @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])),
        "energy": simulation.totals()["kinetic_energy"],
    }


def halves(x):
    return x[:, 0] > 0.001


def quarters(x):
    return 2 * (x[:, 0] > 0.001) + (x[:, 1] > 0.003)


def jagged(x):
    """A crack that is rough at the size of a particle."""
    return x[:, 0] > 0.001 + 0.006 * np.sin(600 * x[:, 1])


def strewn(x):
    """Many parts of all sizes, some of single points."""
    return np.floor(np.random.default_rng(3).uniform(0, 1.1, len(x))) + 2 * jagged(x)


@pytest.mark.parametrize("label", [halves, quarters, jagged])
@pytest.mark.parametrize("body", [DISC, BAR])
def test_parts_at_rest_stay_at_rest(build, body, label):
    simulation = build(body)
    before = sums(simulation)
    cut(simulation, label)
    parts = simulation.fragments()
    assert len(parts["mass"]) == (4 if label is quarters else 2)
    steps(simulation, 100)
    after = sums(simulation)
    assert after["mass"] == before["mass"]
    assert after["energy"] < 1e-18
