"""Rigid bodies: contacts, and their two-way coupling with water."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ..flows import Flows

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

# A block that comes down flat, and touches at 40 points at once.
FLAT = """\
dim = 2
scheme = "resolved"
speed_max = 1
dp = 0.005
time_max = 1
time_out = 1
gravity = [0, 0]

[material.basalt]
restitution = 0.2

[body.block]
shape = "box"
material = "basalt"
min = [-0.05, 0.0002]
max = [0.05, 0.1002]
velocity = [0, -0.1]

[body.bed]
shape = "box"
material = "basalt"
fixed = true
normal = [0, 1]
min = [-0.2, -0.03]
max = [0.2, 0]
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
min = [0.015, 0.015]
max = [0.125, 0.125]
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
    return Flows(tmp_path)(text.format(**values) if values else text)


def to(simulation: Any, time: float) -> Any:
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    return simulation


@pytest.mark.parametrize(("dim", "law"), [(2, "linear"), (3, "linear"), (3, "hertz")])
@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_balls_part_with_their_restitution(tmp_path, dim, law, restitution):
    simulation = to(built(tmp_path, TWO_BALLS, dim=dim, law=law, restitution=restitution), 2e-3)
    grains = simulation.grains()
    speed = grains["velocity"][:, 0]
    assert speed[1] - speed[0] == pytest.approx(3 * restitution, rel=0.02)
    assert speed.sum() == pytest.approx(3, rel=1e-13)
    assert 0 < grains["worst_overlap"] < 0.01


@pytest.mark.parametrize(("dim", "law"), [(2, "linear"), (3, "linear"), (3, "hertz")])
@pytest.mark.parametrize(("young", "same"), [(1e5, True), (5e10, False)])
def test_softened_contacts_are_never_stiffer_than_the_material(tmp_path, dim, law, young, same):
    """Balls as soft as rubber meet as with `stiffness = "material"`; those of rock do not."""
    speeds = []
    for stiffness in ("softened", "material"):
        text = TWO_BALLS.replace("[contact]", f'[contact]\nstiffness = "{stiffness}"')
        text = text.replace("friction = 0", f"friction = 0\nyoung_modulus = {young:g}")
        simulation = built(tmp_path, text, dim=dim, law=law, restitution=1.0)
        speeds.append(to(simulation, 1e-4).grains()["velocity"][:, 0])
    assert np.array_equal(*speeds) is same
    assert 0 < speeds[0][1] < 3  # while they touch, or have touched


def test_a_block_that_lands_flat_leaves_with_its_restitution(tmp_path):
    grains = to(built(tmp_path, FLAT), 0.01).grains()
    (rebound,) = np.asarray(grains["velocity"])[~np.asarray(grains["fixed"]), 1]
    assert rebound == pytest.approx(0.2 * 0.1, rel=0.01)


def test_water_and_bodies_keep_their_momentum(tmp_path):
    simulation = built(tmp_path, CROWDED)
    mass = simulation.totals()["mass"]
    before = np.array(simulation.totals()["momentum"])
    to(simulation, 0.02)
    after = np.array(simulation.totals()["momentum"])
    grain = simulation.grains()
    assert np.linalg.norm(grain["velocity"][0] - [0.3, -0.1]) > 0.005
    assert after == pytest.approx(before, abs=1e-12 * mass)


def test_heavy_discs_sink_to_the_floor(tmp_path):
    grain = to(built(tmp_path, TANK, density=2650), 1.0).grains()
    assert grain["centre"][0, 1] == pytest.approx(0.02, abs=2e-4)
    assert grain["contacts"][0] == 1
    assert np.linalg.norm(grain["velocity"][0]) < 0.05


def test_a_disc_of_half_the_density_bobs_with_its_middle_at_the_surface(tmp_path):
    simulation, above = built(tmp_path, TANK, density=500), []
    for time in np.arange(0.6, 0.95, 0.05):  # one period; later it is chaotic
        grain, state = to(simulation, time).grains(), simulation.state()
        water = state["position"][state["motion"] == 0]
        away = np.abs(water[:, 0] - grain["centre"][0, 0]) > 0.03
        above.append(grain["centre"][0, 1] - np.quantile(water[away, 1], 0.98))
    assert np.mean(above) == pytest.approx(0.0, abs=0.006)


def test_a_disc_released_in_water_carries_water_with_it(tmp_path):
    """a = g (rho_w - rho_s)/(rho_w + rho_s): the added mass of a disc is its volume of water."""
    for density in (500, 2650):
        speed = to(built(tmp_path, TANK, density=density), 0.02).grains()["velocity"][0, 1]
        exact = 9.81 * (1000 - density) / (1000 + density) * 0.02
        assert speed == pytest.approx(exact, rel=0.25)


def test_bodies_go_on_from_a_checkpoint_with_the_same_bits(tmp_path):
    text = TANK.format(density=2650)
    simulation = built(tmp_path, text)
    saved = to(simulation, 0.02).checkpoint()
    other = Flows(tmp_path).empty(text)
    assert other.restore(saved)
    one, two = to(simulation, 0.03).grains(), to(other, 0.03).grains()
    for key in one:
        assert np.array_equal(one[key], two[key]), key


def test_an_outflow_takes_whole_bodies_and_their_mass(tmp_path):
    text = TWO_BALLS + "\n[outflow.right]\nmin = [0.02, -1]\nmax = [1, 1]\n"
    simulation = to(built(tmp_path, text, dim=2, law="linear", restitution=1.0), 0.02)
    totals, grains = simulation.totals(), simulation.grains()
    assert grains["removed"].tolist() == [False, True]
    mass = grains["mass"]
    assert totals["mass_left"] == pytest.approx(mass[1])
    assert totals["mass"] == pytest.approx(mass[0])
    assert np.all(simulation.state()["grain"] == 0)
