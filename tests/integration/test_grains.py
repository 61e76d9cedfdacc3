"""Rigid bodies: contacts, and their two-way coupling with water."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flows import scenario_of

from doseki.core import build_simulation, empty_simulation

TWO_BALLS = """\
dim = {dim}
scheme = "resolved"
speed_max = 5
dp = 0.002
time_max = 1
time_out = 1
gravity = {{ d2 = [0, 0], d3 = [0, 0, 0] }}

[contact]
law = "{law}"
steps = 100

[material.basalt]
restitution = {restitution}
friction = 0

[body.left]
shape = {{ d2 = "disc", d3 = "sphere" }}
material = "basalt"
radius = 0.005
centre = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
velocity = {{ d2 = [3, 0], d3 = [3, 0, 0] }}

[body.right]
shape = {{ d2 = "disc", d3 = "sphere" }}
material = "basalt"
radius = 0.005
centre = {{ d2 = [0.0101, 0], d3 = [0.0101, 0, 0] }}
"""

# Water in a periodic box around a body so large that no water is out of its reach.
CROWDED = """\
dim = 2
scheme = "resolved"
speed_max = 1
dp = 0.01
time_max = 1
time_out = 1
gravity = [0, 0]
shifting = false
periodic = ["x", "y"]
domain_min = [0, 0]
domain_max = [0.14, 0.14]

[body.block]
shape = "box"
material = "basalt"
min = [0.02, 0.02]
max = [0.12, 0.12]
velocity = [0.3, -0.1]
spin = 1.0

[body.water]
shape = "box"
material = "water"
jitter = 0.1
min = [0, 0]
max = [0.14, 0.14]
"""

# A slope on which a grain lies, a tank with a light and a heavy disc: dry, wet, afloat, sunk.
TANK = """\
dim = 2
scheme = "resolved"
speed_max = 1.5
dp = 0.005
time_max = 2
time_out = 1
gravity = [0, -9.81]

[material.wood]
based_on = "basalt"
rho0 = {density}

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
normal = [0, 1]
min = [-0.015, -0.015]
max = [0.165, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
normal = [1, 0]
min = [-0.015, 0]
max = [0, 0.2]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
normal = [-1, 0]
min = [0.15, 0]
max = [0.165, 0.2]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.15, 0.1]
pressure = "= 1000*9.81*(0.1 - y)"

[body.grain]
shape = "disc"
material = "wood"
radius = 0.02
centre = [0.075, 0.05]
"""


def built(tmp_path: Path, text: str, **values: object) -> Any:
    return build_simulation(scenario_of(text, tmp_path, **values))[0]


def to(simulation: Any, time: float) -> Any:
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    return simulation


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("law", ["linear", "hertz"])
@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_balls_part_with_their_restitution(tmp_path, dim, law, restitution):
    simulation = to(built(tmp_path, TWO_BALLS, dim=dim, law=law, restitution=restitution), 2e-3)
    grains = simulation.grains()
    speed = grains["velocity"][:, 0]
    assert speed[1] - speed[0] == pytest.approx(3 * restitution, rel=0.02)
    assert speed.sum() == pytest.approx(3, rel=1e-13)
    assert 0 < grains["worst_overlap"] < 0.01


def test_water_and_bodies_keep_their_momentum(tmp_path):
    simulation = built(tmp_path, CROWDED)
    mass = simulation.totals()["mass"]
    before = np.array(simulation.totals()["momentum"])
    to(simulation, 0.05)
    after = np.array(simulation.totals()["momentum"])
    grain = simulation.grains()
    assert np.linalg.norm(grain["velocity"][0] - [0.3, -0.1]) > 0.02
    assert after == pytest.approx(before, abs=1e-12 * mass)


@pytest.mark.parametrize(("density", "depth"), [(500, 0.0), (2650, 0.08)])
def test_light_discs_float_and_heavy_ones_sink(tmp_path, density, depth):
    """Afloat: the disc displaces its mass, to a spacing; sunk: it rests on the floor."""
    simulation = to(built(tmp_path, TANK, density=density), 1.2)
    grain, state = simulation.grains(), simulation.state()
    height = grain["centre"][0, 1]
    if density > 1000:
        assert height == pytest.approx(0.02, abs=2e-4)
        assert grain["contacts"][0] == 1
    else:
        water = state["position"][state["motion"] == 0]
        away = np.abs(water[:, 0] - grain["centre"][0, 0]) > 0.03
        level = np.quantile(water[away, 1], 0.98)
        assert height == pytest.approx(level, abs=0.0075)
        assert grain["contacts"][0] == 0
    assert np.linalg.norm(grain["velocity"][0]) < 0.08


def test_bodies_go_on_from_a_checkpoint_with_the_same_bits(tmp_path):
    scenario = scenario_of(TANK, tmp_path, density=2650)
    simulation, names = build_simulation(scenario)
    saved = to(simulation, 0.02).checkpoint()
    other = empty_simulation(scenario, names)
    assert other.restore(saved)
    one, two = to(simulation, 0.03).grains(), to(other, 0.03).grains()
    for key in one:
        assert np.array_equal(one[key], two[key]), key


def test_the_pressure_of_water_carries_a_submerged_body(tmp_path):
    """Before it has moved, the force is the weight of the water in its place."""
    simulation = to(built(tmp_path, TANK.replace("centre", "velocity = [0, 0]\ncentre"), density=1000), 0.2)
    force = simulation.grains()["flow_force"][0, 1]
    weight = 1000 * np.pi * 0.02**2 * 9.81
    assert np.abs(simulation.grains()["centre"][0] - [0.075, 0.05]).max() < 0.006
    assert force == pytest.approx(weight, rel=0.5)


def test_an_outflow_takes_whole_bodies_and_their_mass(tmp_path):
    text = TWO_BALLS + "[outflow.right]\nmin = [0.02, -1]\nmax = [1, 1]\n"
    simulation = to(built(tmp_path, text, dim=2, law="linear", restitution=1.0), 0.02)
    totals, grains = simulation.totals(), simulation.grains()
    assert grains["removed"].tolist() == [False, True]
    mass = grains["mass"]
    assert totals["mass_left"] == pytest.approx(mass[1])
    assert totals["mass"] == pytest.approx(mass[0])
    assert np.all(simulation.state()["grain"] == 0)
