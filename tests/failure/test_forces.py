"""The terms that a failure report names add up to what the core computed."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.core import build_simulation
from doseki.forces import RATES, particle_terms
from doseki.scenario import load_scenario


def state_after(scenario, steps):
    """Fields and rates of the particles."""
    simulation, _ = build_simulation(scenario)
    simulation.advance(limit=1.0, pause=1.0, max_steps=steps)
    rates = simulation.rates()
    return simulation.state() | {name: rates[name] for name in RATES}


@pytest.mark.parametrize("name", ["film", "hang"])
def test_terms_add_up_to_the_acceleration(name):
    scenario = load_scenario(name, ["skin=0"])
    state = state_after(scenario, 300)
    scale = np.linalg.norm(state["acceleration"], axis=1).max()
    free = np.flatnonzero(state["motion"] == 0)
    for k in free[:: max(1, len(free) // 7)]:
        total = sum(particle_terms(scenario, state, k).acceleration.values())
        # The core's sums are of the state predicted within the step.
        np.testing.assert_allclose(total, state["acceleration"][k], atol=0.02 * scale)


COLUMN = """\
dim = 2
scheme = "resolved"
speed_max = 1
dp = 0.01
time_max = 1
time_out = 1
gravity = [0, -9.81]

[body.column]
shape = "box"
material = "water"
min = [0, 0]
max = [0.3, 0.3]
pressure = "= 1000*9.81*(0.3 - y)"

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
normal = [0, 1]
min = [-0.03, -0.03]
max = [0.33, 0]
"""


def test_pressure_carries_water_inside_and_not_at_the_side(tmp_path):
    (tmp_path / "column.toml").write_text(COLUMN)
    scenario = load_scenario(str(tmp_path / "column.toml"))
    state = state_after(scenario, 2)

    def terms(x, y):
        k = int(np.argmin(np.linalg.norm(state["position"] - [x, y], axis=1)))
        return particle_terms(scenario, state, k).acceleration

    inside, side = terms(0.155, 0.155), terms(0.005, 0.155)
    np.testing.assert_allclose(inside["pressure"], [0, 9.81], atol=0.3)
    np.testing.assert_allclose(inside["gravity"], [0, -9.81])
    assert np.linalg.norm(inside["viscosity_and_walls"]) < 0.5
    assert side["pressure"][0] < -100
    bottom = terms(0.155, 0.005)
    assert bottom["viscosity_and_walls"][1] > 100


def test_a_drop_without_neighbours_falls(tmp_path):
    alone = COLUMN.replace("max = [0.3, 0.3]", "max = [0.01, 0.01]").split("[body.floor]")[0]
    (tmp_path / "drop.toml").write_text(alone)
    scenario = load_scenario(str(tmp_path / "drop.toml"))
    terms = particle_terms(scenario, state_after(scenario, 2), 0)
    assert len(terms.neighbour) == 0
    assert terms.acceleration["pressure"].tolist() == [0, 0]
    np.testing.assert_allclose(sum(terms.acceleration.values()), [0, -9.81])
