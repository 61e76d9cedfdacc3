"""Short runs with bodies of many shapes."""

from __future__ import annotations

import pytest

from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario

TANK = """\
schema = 1
title = "bodies that turn over a pool"
dim = {dim}
scheme = "resolved"
dp = 0.05
time_max = 0.06
time_out = 0.03
speed_max = 2.0
gravity = {gravity}

[body.water]
shape = "box"
material = "water"
min = {zero}
max = {half}

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = {low}
max = {high}

[body.gate]
shape = "box"
material = "aluminium"
fixed = true
min = {gate_low}
max = {gate_high}

[body.gate.motion]
velocity = {upwards}

[body.ball]
shape = {ball}
material = "basalt"
centre = {ball_centre}
radius = 0.1
spin = {spin}

[body.brick]
shape = "box"
material = "basalt"
min = {brick_low}
max = {brick_high}
rotate = 20
spin = {spin}

[gauge.toe]
kind = "pressure"
position = {toe}

[gauge.column]
kind = "velocity_profile"
position = {toe}
length = 0.4
count = 4

[gauge.middle]
kind = "mass_centre"
"""
PLACES = {
    "gravity": [0, 0, -9.81], "zero": [0, 0, 0], "half": [0.4, 0.3, 0.2],
    "low": [-0.2, -0.2, -0.2], "high": [1.4, 0.5, 0], "gate_low": [1.2, 0, 0.05],
    "gate_high": [1.4, 0.3, 0.45], "upwards": [0, 0, 1.0], "ball_centre": [0.7, 0.15, 0.5],
    "brick_low": [0.9, 0.05, 0.4], "brick_high": [1.1, 0.2, 0.5], "toe": [0.2, 0.1, 0.05],
}  # fmt: skip


def scenario_text(dim):
    """The scenario of the pool in 2 or 3 dimensions."""
    places = {key: value if dim == 3 else value[::2] for key, value in PLACES.items()}
    spin = [0, 20.0, 0] if dim == 3 else 20.0
    return TANK.format(dim=dim, ball='"sphere"' if dim == 3 else '"disc"', spin=spin, **places)


@pytest.fixture(scope="module", params=[2, 3])
def pool(request, tmp_path_factory):
    """A run in 2 and in 3 dimensions, for tests that add to its folder and change nothing."""
    folder = tmp_path_factory.mktemp("pool")
    file = folder / "pool.toml"
    file.write_text(scenario_text(request.param), encoding="utf-8")
    run_scenario(load_scenario(file), folder / "run")
    return load(folder / "run")
