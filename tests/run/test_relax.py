"""Water that comes to rest before a run begins."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.preflight import check_scenario
from doseki.errors import UserError
from doseki.record.particles import FREE
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

TANK = """
dim = 2
scheme = "resolved"
dp = 0.05
speed_max = 3.2
time_max = 1
time_out = 1
gravity = [0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
min = [-0.15, -0.15]
max = [0.65, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [1, 0]
min = [-0.15, 0]
max = [0, 1.2]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [-1, 0]
min = [0.5, 0]
max = [0.65, 1.2]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.5, 1]
pressure = "= 1000*9.8*(1 - y)"

[body.disc]
shape = "disc"
material = "aluminium"
fixed = true
wall = "free_slip"
centre = [0.25, 0.45]
radius = 0.15
"""


def built(tmp_path, *overrides, text=TANK):
    (tmp_path / "tank.toml").write_text(text)
    return build_simulation(load_scenario(str(tmp_path / "tank.toml"), list(overrides)))[0]


def mean_energy(simulation):
    """Over the first second, J/m."""
    energies = []
    for time in np.linspace(0.05, 1, 20):
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        energies.append(simulation.totals()["kinetic_energy"])
    return np.mean(energies)


def test_water_that_has_relaxed_rests(tmp_path):
    relaxed = built(tmp_path, "relax=0.6")
    assert relaxed.time == 0
    assert relaxed.totals()["kinetic_energy"] == 0
    assert mean_energy(relaxed) < 0.3 * mean_energy(built(tmp_path))


def test_it_moves_the_water_and_nothing_else(tmp_path):
    relaxed, plain = built(tmp_path, "relax=0.1").state(), built(tmp_path).state()
    water = plain["motion"] == FREE if "motion" in plain else plain["material"] == 0
    moved = np.linalg.norm(relaxed["position"] - plain["position"], axis=1)
    assert 0 < moved.max() < 0.05
    assert set(np.flatnonzero(moved)) <= set(np.flatnonzero(water))
    assert np.array_equal(relaxed["mass"], plain["mass"])
    again = built(tmp_path, "relax=0.1").state()
    assert np.array_equal(relaxed["position"], again["position"])


def test_bodies_that_move_do_not_wait(tmp_path):
    text = TANK[: TANK.rindex("[body.disc]")] + TANK[TANK.rindex("[body.disc]") :].replace(
        'fixed = true\nwall = "free_slip"\n', ""
    )
    with pytest.raises(UserError, match=r"relax = 0\.1: bodies that move"):
        built(tmp_path, "relax=0.1", text=text)


def test_check_tells_what_relaxing_takes(tmp_path):
    """As many steps for each second as the run itself."""
    (tmp_path / "tank.toml").write_text(TANK)
    told = check_scenario(load_scenario(str(tmp_path / "tank.toml"), ["relax=0.1"]))
    lines = {line[:18].strip(): line[18:] for line in told.splitlines()}
    steps = float(lines["steps"].replace(",", "").split()[0])
    relaxing = float(lines["before it"].split()[1].replace(",", ""))
    assert relaxing == pytest.approx(0.1 * steps, rel=0.3)
    assert "for the 0.1 s in which water relaxes" in lines["before it"]
