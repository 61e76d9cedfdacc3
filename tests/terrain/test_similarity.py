"""A long parabolic pile with Coulomb's friction on a plane of a map: Savage & Hutter's similarity.

Numbers are those of AvaFrame's avaSimilaritySol: 4 m high, 80 m from the middle to either end, 35
degrees, friction of 25 degrees, earth pressure coefficient 1. Savage & Hutter, J. Fluid Mech. 199
(1989); in a frame that slides with g (sin - mu cos) depth and speed stay a parabola and a line,

    h = h0/s (1 - (x/(s L))^2), u = x s'/s, s'' = 2 g cos h0/(L^2 s^2), s(0) = 1, s'(0) = 0,

of which t sqrt(4 g cos h0)/L = sqrt(s (s - 1)) + arsinh sqrt(s - 1).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .scenes import fluid, grid, simulation_of

G, HEIGHT, HALF, SPEED = 9.81, 4.0, 80.0, 5.0
TILT, MU = math.radians(35), math.tan(math.radians(25))
VISCOSITY = 7.0  # m2/s: its shear and its stretching both weigh a tenth of the pressure
CENTRE, CELL, LENGTH = 114.0, 5.0, 500.0  # of the pile along x, of the map, m

# H, N: depth, and height above the slope. The pile starts with the profile of speeds across it that
# friction below and viscosity keep, and at 5 m/s: friction does not ask.
SCENARIO = """
dim = 2
dp = {dp}
time_max = 100
time_out = 100
scheme = "resolved"
gravity = [0, -9.81]
speed_max = 25
[terrain]
file = "terrain.asc"
section = [[2.5, 50], [{length}, 50]]
material = "basalt"
wall = "voellmy"
mu = {mu}
[material.debris]
based_on = "water"
nu = {nu}
[body.pile]
shape = "box"
material = "debris"
min = [{low}, {foot}]
max = [{high}, {top}]
rotate = -35
pivot = [{centre}, {foot}]
where = "= {H} - {N}"
velocity = ["= {cos}*{speed}", "= -{sin}*{speed}"]
pressure = "= {weight}*max(0, {H} - {N})"
"""


def stretch(time):
    """How many times longer the pile is."""
    passed = math.sqrt(4 * G * math.cos(TILT) * HEIGHT) / HALF * time

    def late(s):
        return math.sqrt(s * (s - 1)) + math.asinh(math.sqrt(s - 1)) - passed

    return brentq(late, 1.0, 10.0 + 2 * passed)


def slid(time, mu=MU):
    """How far the middle has come along the slope, m."""
    return SPEED * time + 0.5 * G * (math.sin(TILT) - mu * math.cos(TILT)) * time**2


def test_the_closed_form_solves_its_equation():
    pull = 2 * G * math.cos(TILT) * HEIGHT / HALF**2
    times = [2.0, 5.0, 15.0]
    found = solve_ivp(
        lambda _, y: [y[1], pull / y[0] ** 2], (0, 15), [1, 0], t_eval=times, rtol=1e-10, atol=1e-12
    )
    np.testing.assert_allclose([stretch(t) for t in times], found.y[0], rtol=1e-7)


def misfits(folder, particles, times, mu=MU):
    """L1 of the profile of depth at some times, over its volume; `mu` is that of the run."""
    cos, sin, foot = math.cos(TILT), math.sin(TILT), -(CENTRE) * math.tan(TILT)
    along = f"((x - {CENTRE})*{cos} - (y - {foot})*{sin})"
    across = f"((x - {CENTRE})*{sin} + (y - {foot})*{cos})"
    depth = f"max(0, {HEIGHT}*(1 - ({along}/{HALF})**2))"
    shear = MU * G * cos / VISCOSITY
    grid(folder / "terrain.asc", lambda x, y: -(x - 2.5) * math.tan(TILT), (LENGTH, 100.0), CELL)
    path = folder / "case.toml"
    path.write_text(
        SCENARIO.format(
            dp=HEIGHT / particles, length=LENGTH - 10, mu=mu, nu=VISCOSITY, cos=cos, sin=sin,
            low=CENTRE - HALF, high=CENTRE + HALF, foot=foot, top=foot + HEIGHT, centre=CENTRE,
            H=depth, N=across, weight=1000 * G * cos,
            speed=f"({SPEED} + {shear}*({depth}*{across} - {across}**2/2 - {depth}**2/3))",
        )
    )  # fmt: skip
    simulation, _ = simulation_of(path)
    found = []
    for time in times:
        simulation.advance(limit=time, pause=time, max_steps=10**8)
        state = simulation.state()
        own = fluid(state)
        x, y = (state["position"][own] - [CENTRE, foot]).T
        volume, half = (state["mass"] / state["density"])[own], stretch(time) * HALF
        edges = slid(time) + half * np.linspace(-1.5, 1.5, 61)
        parts, _ = np.histogram(x * cos - y * sin, edges, weights=volume)
        place = np.clip((edges - slid(time)) / half, -1, 1)
        exact = HEIGHT * HALF * np.diff(place - place**3 / 3)
        outside = 4 / 3 * HEIGHT * HALF - parts.sum()
        found.append((np.abs(parts - exact).sum() + abs(outside)) / exact.sum())
    return found


@pytest.mark.validate
def test_the_profile_stays_that_of_the_solution(tmp_path):
    """At 8 particles over the depth, while the pile slides 86 m and becomes a quarter longer."""
    assert max(misfits(tmp_path, 8, [0.5, 2.5, 5.0, 7.5])) < 0.05


@pytest.mark.validate
def test_with_three_degrees_more_of_friction_it_does_not(tmp_path):
    assert misfits(tmp_path, 8, [5.0], mu=math.tan(math.radians(28)))[0] > 0.05
