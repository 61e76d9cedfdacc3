"""Flows on terrains against closed forms, and against walls of particles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .scenes import LAKE, fluid, grid, profile, simulation_of, text

MASS = """
[material.debris]
based_on = "water"
rheology = "mu_i"
mu_s = 1.2
mu_2 = 1.4
inertial_number = 0.3
grain_diameter = 0.05
grain_density = 2650
viscosity_max = 1e5
"""
BLOCK = """
[body.block]
shape = "release"
material = "debris"
between = [{low}, {high}]
thickness = 0.5
"""
TILT, MU = math.radians(25), 0.25


def bend(x):
    """A slope of 25 degrees, an arc of radius 30 m, and a level run-out from x = 30 m on."""
    radius, foot = 30.0, 30.0
    start = foot - radius * math.sin(TILT)
    arc = radius - np.sqrt(np.maximum(radius**2 - (foot - np.clip(x, start, foot)) ** 2, 0.0))
    return arc + np.maximum(start - x, 0.0) * math.tan(TILT)


def train(centre, length, time, mu):
    """Place, m, and speeds, m/s, of the middle of a train of masses that follows the bend.

    Each has Coulomb's friction: dv/dt = g sin t - mu (g cos t + v2 kappa), kappa being the
    curvature of the bed; they go with the mean of it, `length` m from the first to the last.
    """
    g, dt, e = 9.81, 2e-4, 1e-4
    x, v = centre + np.linspace(-0.5, 0.5, 21) * length, 0.0
    middles, speeds = [centre], [0.0]
    for _ in range(round(time / dt)):
        slope = (bend(x + e) - bend(x - e)) / (2 * e)
        bent = (bend(x + e) - 2 * bend(x) + bend(x - e)) / e**2
        cos = 1 / np.hypot(1, slope)
        gain = -g * slope * cos - mu * (g * cos + v * v * bent * cos**3)
        v = max(0.0, v + dt * float(gain.mean()))
        x = x + dt * v * cos
        middles.append(float(x.mean()))
        speeds.append(v)
    return np.array(middles), np.array(speeds)


def slid(path, time, settings=()):
    """Mean place, speed of the centre, and length along x of what flows, at times 0.05 s apart."""
    simulation, _ = simulation_of(path, settings)
    places, speeds, lengths = [], [], []
    while simulation.time < time:
        simulation.advance(limit=time, pause=simulation.time + 0.05, max_steps=10**6)
        state = simulation.state()
        own = fluid(state)
        x = state["position"][own][:, 0]
        places.append(float(x.mean()))
        speeds.append(float(np.linalg.norm(state["velocity"][own].mean(axis=0))))
        lengths.append(float(np.ptp(np.percentile(x, (2, 98)))))
    return places, speeds, lengths


@pytest.mark.minutes
@pytest.mark.parametrize("sign", [1, -1])
def test_a_block_slides_as_a_point_mass_does(tmp_path, sign):
    profile(tmp_path / "terrain.csv", lambda x: bend(sign * x), *sorted((0.0, sign * 60.0)))
    path = tmp_path / "case.toml"
    low, high = sorted((sign * 3.0, sign * 5.0))
    more = f"mu = {MU}\n" + MASS + BLOCK.format(low=low, high=high)
    path.write_text(text(2, dp=0.0625, speed=13.0, wall="voellmy", more=more))
    places, speeds, lengths = slid(path, 10.0)
    on_slope = 9.81 * (math.sin(TILT) - MU * math.cos(TILT)) * 2.5
    assert speeds[49] == pytest.approx(on_slope, rel=0.02)
    start = 4.0 + 0.25 * math.sin(TILT)
    middles, exact = train(start, lengths[49], 10.0, MU)
    # A thick block works against its own friction where the bed bends.
    assert max(speeds) == pytest.approx(exact.max(), rel=0.03)
    assert sign * places[-1] - start == pytest.approx(middles[-1] - start, rel=0.05)
    assert abs(places[-1] - places[-5]) < 0.02, "it has stopped"


@pytest.mark.parametrize("tilt", [10, -10])
def test_a_block_stops_where_friction_has_taken_its_energy(tmp_path, tilt):
    """It starts down a slope that is too gentle to slide on: v2 = 2 g (mu cos t - sin t) s."""
    mu, v, angle = 0.5, 5.0, math.radians(abs(tilt))
    down = math.copysign(1.0, tilt)
    profile(tmp_path / "terrain.csv", lambda x: -math.tan(math.radians(tilt)) * x, -20.0, 20.0)
    path = tmp_path / "case.toml"
    velocity = f"velocity = [{down * v * math.cos(angle)}, {-v * math.sin(angle)}]\n"
    more = f"mu = {mu}\n" + MASS + BLOCK.format(low=-1.0, high=1.0) + velocity
    path.write_text(text(2, dp=0.125, speed=8.0, wall="voellmy", more=more))
    places, speeds, _ = slid(path, 2.5)
    way = v**2 / (2 * 9.81 * (mu * math.cos(angle) - math.sin(angle))) * math.cos(angle)
    start = 0.25 * math.sin(angle)
    assert down * places[-1] - start == pytest.approx(way, rel=0.02)
    assert speeds[-1] < 0.02


def test_without_friction_it_does_not_stop(tmp_path):
    """The control."""
    profile(tmp_path / "terrain.csv", bend, 0.0, 60.0)
    path = tmp_path / "case.toml"
    more = "mu = 0.0\n" + MASS + BLOCK.format(low=3.0, high=5.0)
    path.write_text(text(2, dp=0.125, speed=13.0, wall="voellmy", more=more))
    _, speeds, _ = slid(path, 2.5)
    assert max(speeds) > 1.5 * 9.81 * (math.sin(TILT) - MU * math.cos(TILT)) * 2.5


PLANE = """
[body.layer]
shape = "release"
material = "oil"
between = [1.0, 3.0]
thickness = 0.3
[material.oil]
based_on = "water"
nu = 0.05
"""
BOX = """
dim = 2
dp = 0.025
time_max = 1
time_out = 1
scheme = "resolved"
gravity = [0, -9.81]
speed_max = 3.0
[material.oil]
based_on = "water"
nu = 0.05
[body.bed]
shape = "box"
material = "basalt"
fixed = true
wall = "{wall}"
{ks}
min = [-1.0, -0.075]
max = [9.0, 0.0]
rotate = {turn}
pivot = [0, 0]
[body.layer]
shape = "box"
material = "oil"
min = [{low}, 0]
max = [{high}, 0.3]
rotate = {turn}
pivot = [0, 0]
"""


@pytest.mark.parametrize(("wall", "ks"), [("no_slip", ""), ("free_slip", ""), ("rough", 0.02)])
def test_a_plane_of_a_map_is_as_good_as_a_box(tmp_path, wall, ks):
    """A layer of oil on 20 degrees: how far its centre goes in half a second."""
    tilt = math.radians(20)
    profile(tmp_path / "terrain.csv", lambda x: -math.tan(tilt) * x, -1.0, 9.0)
    keys = f"ks = {ks}\n" if ks else ""
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.025, speed=3.0, wall=wall, more=keys + PLANE))
    on_map, _, _ = slid(path, 0.5)
    low, high = 1.0 / math.cos(tilt), 3.0 / math.cos(tilt)
    path.write_text(BOX.format(wall=wall, ks=keys, turn=-20, low=low, high=high))
    on_box, _, _ = slid(path, 0.5)
    start = 2.0 + 0.15 * math.sin(tilt)
    assert on_map[-1] - start == pytest.approx(on_box[-1] - start, rel=0.02)
    assert on_map[-1] - start > 0.05


def lake(folder, sign=1, moved=0.0, shift=(0.0, 0.0), relax=2.0):
    """A lake's kinetic energy over rho g H2, in the mean of a second, and its pressure.

    Of that its fall with height and the L2 of what is not in a line with it, over rho g.

    Its bumpy bed is mirrored for a `sign` of -1, and `moved` under the rows of particles.
    """

    def bed(x):
        return 0.3 * np.abs(x - moved) ** 1.5 + sign * 0.1 * np.sin(4 * (x - moved))

    profile(folder / "terrain.csv", bed, -3.0 + moved, 3.0 + moved, 0.01, shift)
    level, path = 1.0 + shift[1], folder / "case.toml"
    ends = {"west": shift[0] - 2.6, "east": shift[0] + 2.6, "floor": shift[1] - 0.3}
    words = text(2, dp=0.05, speed=4.5, more=LAKE.format(level=level, **ends))
    path.write_text(words.replace("speed_max", f"relax = {relax}\nspeed_max"))
    simulation, _ = simulation_of(path)
    energies = []
    for time in 0.05 * np.arange(1, 21):
        simulation.advance(limit=1.0, pause=time, max_steps=10**6)
        energies.append(simulation.totals()["kinetic_energy"])
    state = simulation.state()
    own = fluid(state)
    depth = state["position"][own][:, 1] - shift[1]
    pressure = state["pressure"][own]
    slope, offset = np.polyfit(depth, pressure, 1)
    misfit = np.sqrt(np.mean((pressure - (slope * depth + offset)) ** 2))
    return np.mean(energies) / (9810 * 1.05**2), -slope / 9810, misfit / 9810


def test_a_lake_on_a_bumpy_bed_stays_at_rest(tmp_path):
    """In the mean of lakes: now and then a row slips along the bed, in each elsewhere."""
    ways = [{}, {"sign": -1}, {"moved": 0.02}, {"shift": (460800.0, 2048.0)}]
    energy, fall, misfit = np.transpose([lake(tmp_path, **way) for way in ways])
    assert misfit.max() < 0.01
    assert fall == pytest.approx(1.0, rel=0.015)
    assert energy.mean() < 1.5e-5
    assert energy[3] == pytest.approx(energy[0], rel=0.1), "far from zero it is the same lake"


def test_a_lake_that_was_not_left_to_settle_is_not_at_rest(tmp_path):
    """The control."""
    assert lake(tmp_path, relax=0.01)[0] > 2 * 1.5e-5


def test_a_slope_that_is_turned_gives_the_turned_flow(tmp_path):
    """In 3-D down x, down -y, and between the two: rows of walls lie differently in each."""
    ways = []
    for angle in (0.0, -90.0, -37.0):
        turn = math.radians(angle)
        down = np.array([math.cos(turn), math.sin(turn)])
        grid(tmp_path / "terrain.asc", lambda x, y, d=down: 5 - 0.4 * (d[0] * x + d[1] * y),
             (8.0, 8.0))  # fmt: skip
        side = np.array([-down[1], down[0]])
        corners = [
            (np.array([4.0, 4.0]) + a * down + b * side).tolist()
            for a, b in ((-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8))
        ]
        path = tmp_path / "case.toml"
        path.write_text(
            text(3, dp=0.1, speed=6.0, more=f"""
[body.slide]
shape = "release"
material = "water"
polygon = {corners}
thickness = 0.4
""")
        )  # fmt: skip
        simulation, _ = simulation_of(path)
        simulation.advance(limit=0.5, pause=0.5, max_steps=10**6)
        state = simulation.state()
        centre = state["position"][fluid(state)].mean(axis=0)
        ways.append([(centre[:2] - 4.0) @ down, (centre[:2] - 4.0) @ side])
    assert ways[1][0] == pytest.approx(ways[0][0], rel=0.01)
    assert ways[2][0] == pytest.approx(ways[0][0], rel=0.02)
    assert np.abs(np.array(ways)[:, 1]).max() < 0.02 * ways[0][0]
