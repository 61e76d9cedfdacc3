"""Liquids and bodies that turn: what turns with its surroundings is at rest in them."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.particles import FREE
from doseki.validate.estimators import angular_momentum, moments
from doseki.validate.running import moving

from ..flows import advance

HEAD = """\
dim = 2
scheme = "resolved"
speed_max = 3
dp = 0.01
time_max = 1
time_out = 1
gravity = [0, 0]

[material.oil]
based_on = "water"
nu = 0.01

[material.light]
based_on = "basalt"
rho0 = 1000
"""
DROP = """
[body.drop]
shape = "disc"
material = "oil"
centre = [{x}, 0]
radius = 0.1
velocity = ["= -3*y", "= 3*(x - {x})"]
"""
# A disc that spins in water under pressure, between walls without friction.
SPINNING = """
[body.water]
shape = "box"
material = "water"
pressure = 5000
min = [-0.2, -0.2]
max = [0.2, 0.2]

[body.tank]
shape = "tank"
material = "basalt"
min = [-0.2, -0.2]
max = [0.2, 0.2]
open = []
wall = "free_slip"

[body.disc]
shape = "disc"
material = "light"
centre = {centre}
radius = 0.06
spin = 8
"""
# A tank that turns with its liquid.
TURNING = """
[body.liquid]
shape = "box"
material = "{material}"
min = [-0.1, -0.1]
max = [0.1, 0.1]
velocity = ["= -{rate}*y", "= {rate}*x"]
pressure = "= 500*{rate}**2*(x**2 + y**2) + 1000"

[body.tank]
shape = "tank"
material = "basalt"
min = [-0.1, -0.1]
max = [0.1, 0.1]
open = []
wall = "{wall}"
motion = {{ angular_velocity = {rate}, pivot = [0, 0], start = 0 }}
"""


def turning_of_free(simulation, x=0.0):
    """Angular momentum, kg m/s, of what is free, about a point of the axis x."""
    free = moving(simulation.state())
    return angular_momentum(free | {"position": free["position"] - (x, 0)})


def until(simulation, time):
    """The same simulation at a time."""
    simulation.advance(limit=time, pause=time, max_steps=10**6)
    return simulation


@pytest.mark.parametrize(
    ("viscosity", "kept"), [("stress", True), ("monaghan_cleary", True), ("morris", False)]
)
@pytest.mark.parametrize("x", [0.0, 1.003])
def test_a_drop_of_oil_goes_on_turning(flows, viscosity, kept, x):
    """Nothing touches it. The divergence of mu grad v takes 4 nu/R^2 of its angular momentum."""
    run = flows(HEAD + DROP.format(x=x), f"viscosity={viscosity}")
    before = turning_of_free(run, x)
    after = turning_of_free(until(run, 0.1), x)
    assert (abs(after / before - 1) < 0.005) == kept


@pytest.mark.parametrize("centre", [[0, 0], [0.013, -0.007]])
def test_a_disc_spins_on_in_water_under_pressure(flows, centre):
    """Pressure passes through its axis, and the viscosity of water takes 0.4 % here."""
    run = until(flows(HEAD + SPINNING.format(centre=centre)), 0.2)
    assert run.grains()["spin"][0][2] == pytest.approx(8, rel=0.03)


@pytest.mark.parametrize("pressure", [0, 2000])
def test_a_disc_that_spins_slowly_spins_on(flows, pressure):
    """Eight particles across. Pressure has no moment on it, however the water lies around it."""
    disc = SPINNING.format(centre=[0.0031, 0.0017]).replace("spin = 8", "spin = -2")
    disc = disc.replace("radius = 0.06", "radius = 0.04").replace("5000", str(pressure))
    run = until(flows(HEAD + disc.replace('wall = "free_slip"\n', "")), 0.2)
    assert run.grains()["spin"][0][2] == pytest.approx(-2, rel=0.01)


@pytest.mark.parametrize("rate", [2, -2])
def test_a_disc_turns_with_tank_and_liquid(flows, rate):
    """Beside the axis, and under pressure."""
    disc = f"""
[body.disc]
shape = "disc"
material = "light"
centre = [0.04, 0]
radius = 0.04
velocity = [0, {0.04 * rate}]
spin = {rate}
"""
    tank = TURNING.format(wall="no_slip", material="water", rate=rate)
    run = until(flows(HEAD + tank + disc), 0.3)
    assert run.grains()["spin"][0][2] == pytest.approx(rate, rel=0.01)


@pytest.mark.parametrize(
    ("wall", "material"), [("free_slip", "water"), ("no_slip", "water"), ("no_slip", "oil")]
)
def test_a_tank_does_not_feel_the_liquid_that_turns_with_it(flows, wall, material):
    """Shear of mu omega all along its walls would be 2.4 N in oil, twice its area."""
    run = until(flows(HEAD + TURNING.format(wall=wall, material=material, rate=3)), 0.2)
    state = advance(run, 1).state()
    walls = state["motion"] != FREE
    of_forces = moments(state["position"][walls], state["force"][walls])
    assert abs((of_forces + state["moment"][walls]).sum()) < 0.1


def test_bodies_get_the_moments_that_the_liquid_gives(flows):
    """Free disc in oil that turns: what the disc gains the oil loses."""
    disc = """
[body.disc]
shape = "disc"
material = "light"
centre = [0, 0]
radius = 0.04
"""
    tank = SPINNING.split("[body.disc]")[0].replace('"water"\npressure', '"oil"\npressure')
    run = flows(HEAD + tank + disc, "body.water.velocity=['= -3*y', '= 3*x']")
    inertia = 0.5 * 1000 * np.pi * 0.04**4
    until(run, 0.002)
    spin, turning = run.grains()["spin"][0][2], turning_of_free(run)
    until(run, 0.02)
    gained = inertia * (run.grains()["spin"][0][2] - spin)
    assert gained > 0.2 * inertia
    assert turning - turning_of_free(run) > gained


def test_pressure_rises_to_a_wall_that_turns(flows):
    """By rho omega2 r, as in the liquid: a wall without acceleration would bear what is a spacing
    before it, 100 Pa less here.
    """
    run = until(flows(HEAD + TURNING.format(wall="free_slip", material="water", rate=10)), 1e-4)
    state = run.state()
    position, walls = state["position"], state["motion"] != FREE
    away = np.abs(position).max(axis=1) - 0.1
    face = walls & (away < 0.01) & (np.abs(position).min(axis=1) < 0.06)
    exact = 50000 * (position[face] ** 2).sum(axis=1) + 1000
    assert np.abs(state["pressure"][face] - exact).mean() < 30


FLOAT = """\
dim = 2
scheme = "resolved"
speed_max = 2.2
dp = 0.025
time_max = 1
time_out = 1
gravity = [0, -9.81]

[material.wood]
based_on = "basalt"
rho0 = 600

[body.water]
shape = "box"
material = "water"
min = [-1, -0.5]
max = [1, 0]
pressure = "= -9810*y"

[body.float]
shape = "box"
material = "wood"
min = [-0.25, -0.12]
max = [0.25, 0.08]
rotate = {tilt}
pivot = [0, 0]

[body.tank]
shape = "tank"
material = "aluminium"
min = [-1, -0.5]
max = [1, 0.4]
wall = "free_slip"
"""


@pytest.mark.parametrize("tilt", [10, -10])
def test_the_water_sees_how_a_float_begins_to_turn(flows, tilt):
    """Its points have the angular acceleration that the water gives it, which is all of it."""
    run = flows(FLOAT.format(tilt=tilt))
    times = [0.05, 0.06]
    spins = [until(run, time).grains()["spin"][0][2] for time in times]
    gained = (spins[1] - spins[0]) / (times[1] - times[0])
    state = run.state() | {"acceleration": run.rates()["acceleration"]}
    own = state["body"] == 1
    away = state["position"][own] - run.grains()["centre"][0]
    turning = moments(away, state["acceleration"][own]).sum() / (away**2).sum()
    assert np.sign(turning) == -np.sign(tilt)
    assert turning == pytest.approx(gained, rel=0.2)
