"""What acts on one particle, as the core takes it apart."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation


def started(scenario, steps):
    """A simulation after a few steps."""
    simulation = build_simulation(scenario)[0]
    simulation.advance(limit=1.0, pause=1.0, max_steps=steps)
    return simulation


def total(terms):
    return sum(terms["acceleration"].values())


@pytest.mark.parametrize("precision", ["double", "mixed"])
@pytest.mark.parametrize("name", ["film", "hang"])
def test_terms_add_up_to_the_acceleration(name, precision):
    simulation = started(load_scenario(name, ["skin=0", f"precision={precision}"]), 300)
    state, acceleration = simulation.state(), simulation.rates()["acceleration"]
    scale = np.linalg.norm(acceleration, axis=1).max()
    free = np.flatnonzero(state["motion"] == 0)
    for k in free[:: max(1, len(free) // 7)]:
        terms = simulation.force_terms(int(state["id"][k]))
        error = 1e-12 if precision == "double" else 1e-5
        np.testing.assert_allclose(total(terms), acceleration[k], atol=error * scale)


def test_the_smallest_limit_of_all_particles_is_the_timestep():
    simulation = started(load_scenario("hang"), 20)
    state = simulation.state()
    limits = [simulation.force_terms(int(k))["timestep"] for k in state["id"][state["motion"] == 0]]
    smallest = min(min(limit.values()) for limit in limits)
    assert smallest == pytest.approx(simulation.rates()["timestep"], rel=1e-9)


def test_fixed_particles_have_no_terms():
    simulation = started(load_scenario("film"), 2)
    state = simulation.state()
    fixed = int(state["id"][state["motion"] == 1][0])
    for particle in (fixed, -1):
        assert simulation.force_terms(particle) == {"acceleration": {}, "timestep": {}}


def test_a_state_that_was_restored_has_terms():
    scenario = load_scenario("film")
    simulation = started(scenario, 50)
    copy = started(scenario, 0)
    copy.restore(simulation.checkpoint())
    for particle in (500, 900):
        own, other = (s.force_terms(particle)["acceleration"] for s in (simulation, copy))
        for name, term in own.items():
            np.testing.assert_allclose(
                other[name], term, atol=0.05 * np.linalg.norm(total({"acceleration": own})) + 0.05
            )


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
    simulation = started(scenario, 1)
    state = simulation.state()

    def terms(x, y):
        k = int(np.argmin(np.linalg.norm(state["position"] - [x, y], axis=1)))
        return simulation.force_terms(int(state["id"][k]))["acceleration"]

    inside, side = terms(0.155, 0.155), terms(0.005, 0.155)
    np.testing.assert_allclose(inside["pressure"], [0, 9.81], atol=0.3)
    np.testing.assert_allclose(inside["gravity"], [0, -9.81])
    for name in ("viscosity", "walls", "shifting"):
        assert np.linalg.norm(inside[name]) < 0.5, name
    assert side["pressure"][0] < -50
    bottom = terms(0.155, 0.005)
    assert bottom["walls"][1] > 100


def test_a_drop_without_neighbours_falls(tmp_path):
    alone = COLUMN.replace("max = [0.3, 0.3]", "max = [0.01, 0.01]").split("[body.floor]")[0]
    (tmp_path / "drop.toml").write_text(alone)
    scenario = load_scenario(str(tmp_path / "drop.toml"))
    terms = started(scenario, 2).force_terms(0)["acceleration"]
    assert terms["pressure"].tolist() == [0, 0]
    np.testing.assert_allclose(total({"acceleration": terms}), [0, -9.81])
