"""Force gauges, and normals of walls that turn, in the resolved scheme."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.driver.gauges import build_gauges
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

TANK = """\
dim = 2
dp = 0.02
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 1.5
gravity = [0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.06, -0.06]
max = [0.46, 0]

[body.gate]
shape = "box"
material = "aluminium"
fixed = true
min = [0.4, 0]
max = [0.46, 0.4]
normal = [-1, 0]
motion = { angular_velocity = -2, pivot = [0.4, 0] }

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.2]

[gauge.gate]
kind = "force"
bodies = ["gate"]
about = [0.4, 0]
"""


def test_force_and_moment_are_those_of_the_particles(tmp_path):
    (tmp_path / "tank.toml").write_text(TANK)
    scenario = load_scenario(str(tmp_path / "tank.toml"))
    simulation, names = build_simulation(scenario)
    simulation.advance(limit=0.02, pause=0.02, max_steps=10**6)
    ((time, fx, fy, moment, *contact),) = build_gauges(scenario, names)[0].read(simulation)
    state = simulation.state()
    gate = state["body"] == names.index("gate")
    f, x = state["force"][gate], state["position"][gate] - [0.4, 0]
    assert time == 0.02
    assert contact == [0, 0, 0]
    assert fx > 10
    np.testing.assert_allclose([fx, fy], f.sum(axis=0))
    own = state["moment"][gate].sum()  # of the forces about the particles
    assert 0 < abs(own) < 0.05 * abs(moment)
    assert moment == pytest.approx(float(np.sum(x[:, 0] * f[:, 1] - x[:, 1] * f[:, 0]) + own))


def test_normals_turn_with_the_wall(tmp_path):
    (tmp_path / "tank.toml").write_text(TANK)
    simulation, names = build_simulation(load_scenario(str(tmp_path / "tank.toml")))
    simulation.advance(limit=0.05, pause=0.05, max_steps=10**6)
    state = simulation.state()
    normal = state["normal"][state["body"] == names.index("gate")]
    expected = [-np.cos(0.1), np.sin(0.1)]
    np.testing.assert_allclose(normal, np.broadcast_to(expected, normal.shape), atol=1e-12)
