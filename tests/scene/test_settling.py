"""Grains that settle before the start: at rest in the run, held by their box; what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation
from doseki.solver.settling import IDLE, PATIENCE, Watch

TOP = 'scheme = "resolved"\nspeed_max = 10\ngravity = [0, -9.81]'
FLOOR = """
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [-1, -1]
max = [11, 0]
"""
LOAD = """
[body.load]
shape = "disc"
material = "basalt"
min = [0, 0]
max = [10, 10]
d = 1
count = 40
packing = 0.7
settle = true
"""
SECOND = LOAD.replace("load", "more").replace("[0, 0]", "[0, 7]").replace("[10, 10]", "[10, 20]")
PERIODIC = '\nperiodic = ["x"]\ndomain_min = [0, -5]\ndomain_max = [10, 30]'
TROUGH = FLOOR.replace("[-1, -1]", "[0, -1]").replace("[11, 0]", "[10, 0]")


def grains_of(write, tables, top=TOP):
    scenario = load_scenario(write(top=top, tables=tables), ["dp=0.2"])
    simulation, _, warnings = filled_simulation(scenario)
    simulation.start()
    assert warnings == []
    return scenario, simulation


def mine(simulation):
    table = simulation.grains()
    return {key: table[key][~table["fixed"]] for key in ("centre", "velocity", "overlap", "body")}


def test_grains_start_at_rest_on_one_another(write):
    _, simulation = grains_of(write, TROUGH + LOAD, TOP + PERIODIC)
    before = mine(simulation)
    assert not before["velocity"].any()
    simulation.advance(limit=0.3, pause=0.3, max_steps=10**6)
    after = mine(simulation)
    shift = after["centre"] - before["centre"]
    shift[:, 0] -= 10 * np.rint(shift[:, 0] / 10)
    assert np.abs(shift).max() < 0.02
    assert (after["overlap"] > 0).all()


def test_the_sides_of_the_box_hold_them_until_the_start(write):
    _, simulation = grains_of(write, FLOOR + LOAD)
    x = mine(simulation)["centre"][:, 0]
    assert x.min() > 0.49
    assert x.max() < 9.51
    simulation.advance(limit=1.0, pause=1.0, max_steps=10**6)
    assert np.ptp(mine(simulation)["centre"][:, 0]) > np.ptp(x) + 0.5


def test_one_body_settles_on_another(write):
    _, simulation = grains_of(write, FLOOR + LOAD + SECOND)
    table = mine(simulation)
    first, second = (table["centre"][table["body"] == k, 1] for k in np.unique(table["body"]))
    assert second.min() > np.median(first)
    assert second.min() < first.max() + 1.01


def test_settling_for_some_time(write):
    _, packed = grains_of(write, FLOOR + LOAD.replace("true", "false"))
    _, simulation = grains_of(write, FLOOR + LOAD.replace("true", "0.1"))
    fallen = mine(packed)["centre"][:, 1] - mine(simulation)["centre"][:, 1]
    assert 0.03 < fallen.max() < 0.5 * 9.81 * 0.1**2 + 0.01


def test_what_comes_no_nearer_to_rest_is_ended_with_a_message(write):
    downhill = TOP.replace("[0, -9.81]", "[9, -4]") + PERIODIC
    few = LOAD.replace("count = 40", "count = 8").replace("packing = 0.7", "packing = 0.35")
    scenario = load_scenario(write(top=downhill, tables=TROUGH + few), ["dp=0.2"])
    told = []
    (warning,) = filled_simulation(scenario, tell=told.append).warnings
    assert warning.place == "load"
    assert 0 < warning.idle < warning.time < warning.idle * PATIENCE / IDLE
    assert "brought no grain nearer to rest" in str(warning)
    assert "rolling_friction" in str(warning)
    assert all(text.startswith("body.load settles: ") for text in told)
    assert len(set(told)) > 10


def test_falling_and_calming_are_progress():
    watch = Watch(diameter=1.0)
    for time, speed, height in [(0, 0, 5), (1, 3, 4), (2, 4, 2), (3, 1, 2), (4, 0.5, 2.1)]:
        watch.see(time, np.array([speed]), np.array([height]))
    assert watch.idle == 0
    watch.see(5, np.array([0.49]), np.array([2.05]))
    watch.see(6, np.array([0.5]), np.array([2.0]))
    assert watch.idle == 2


@pytest.mark.parametrize(
    ("tables", "top", "part"),
    [
        (LOAD, TOP, "fall out of the scene"),
        (FLOOR + LOAD, TOP.replace("-9.81", "0"), "no gravity"),
        (FLOOR + LOAD + "fixed = true", TOP, "body.load.settle: only solids"),
        (FLOOR + LOAD.replace("true", "-1"), TOP, "settle = -1"),
        (FLOOR + LOAD.replace("true", '"yes"'), TOP, 'settle = "yes"'),
    ],
)
def test_errors(write, tables, top, part):
    with pytest.raises(UserError, match=r"body\.load") as caught:
        grains_of(write, tables, top)
    assert part in str(caught.value)


@pytest.mark.parametrize("top", [TOP, TOP.replace("[0, -9.81]", "[0, -5]")])
def test_those_after_may_start_where_those_before_stood(write, top):
    """The first has come down before the second is there."""
    loose = (LOAD + SECOND.replace("[0, 7]", "[0, 6]")).replace("packing = 0.7", "packing = 0.35")
    path = write(top=top, tables=FLOOR + loose.replace("settle = true", "settle = 3"))
    simulation, _, _ = filled_simulation(load_scenario(path, ["dp=0.2"]))
    simulation.start()
    table = simulation.grains()
    free = ~np.asarray(table["fixed"])
    low, high = (
        np.asarray(table["centre"])[free][which, 1] for which in (slice(40), slice(40, 80))
    )
    assert high.mean() > low.mean() + 2


def test_but_not_where_those_before_have_come_to_rest(write):
    second = SECOND.replace("[0, 7]", "[0, 1]")
    with pytest.raises(UserError, match=r"body\.more: a body of it overlaps load by .* move one"):
        grains_of(write, FLOOR + LOAD + second)
