"""Dams on maps: water at rest in a channel with banks, in a basin and in 2-D."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.driver.gauges import build_gauges
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.scene.ground import ground_of
from doseki.solver.build import build_simulation

from .scenes import grid, profile, text

G, DEPTH, FACE = 9.81, 0.4, 1.6  # m/s2; water at the dam as filled, its place along x, m
PARTS = ("static", "dynamic", "contact")

# The dam reaches three spacings into the bed and the banks.
LAKE = """
dim = 3
dp = 0.04
time_max = 0.5
time_out = 0.5
scheme = "resolved"
gravity = [0, 0, -9.81]
speed_max = 2.0
relax = 3.0
[terrain]
file = "terrain.asc"
material = "basalt"
wall = "free_slip"
[body.lake]
shape = "box"
material = "water"
min = [0.2, 0.1, -0.12]
max = [1.6, 1.9, 0.4]
pressure = "= 9810*(0.4 - z)"
[body.dam]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [-1, 0, 0]
min = [1.6, 0.05, -0.17]
max = [1.72, 1.95, 0.52]
[gauge.dam]
kind = "load"
bodies = ["dam"]
interval = 0.02
[gauge.level]
kind = "surface_height"
position = [1.2, 1.0, 0.04]
interval = 0.02
"""


def channel(x, y):
    """A bed 0.4 m wide that falls by 1 in 10 to the dam, banks of 45 degrees, a slope behind."""
    banks = np.maximum(np.abs(y - 1.0) - 0.2, 0.0)
    return -0.1 * (x - FACE) + banks + np.maximum(0.7 - x, 0.0)


def hydrostatic(scenario, level):
    """Thrust of water that stands to `level` in the section of the ground at the dam, N."""
    y = np.linspace(0.1, 1.9, 3601)
    places = np.column_stack([np.full_like(y, FACE), y])
    ground = ground_of(scenario.bed).field.at(np.ascontiguousarray(places))["height"]
    depth = np.maximum(level - ground, 0.0)
    return 0.5 * 1000 * G * float(np.mean(depth**2)) * (y[-1] - y[0])


def across_a_channel(folder, lake=LAKE):
    """The record of the load on a dam in 3-D, and the thrust at the level that the water has."""
    grid(folder / "terrain.asc", channel, (2.4, 2.0), 0.05)
    path = folder / "case.toml"
    path.write_text(lake)
    scenario = load_scenario(path)
    run_scenario(scenario, folder / "run", RunOptions(threads=1))
    gauges = load(folder / "run").gauges
    level = 0.04 + float(gauges["level"]["height"][1:].mean())
    # Water has no particles in the sharp corners of its banks: it stands a little lower.
    assert 0.95 * DEPTH < level < 1.01 * DEPTH
    return gauges["dam"], hydrostatic(scenario, level)


def rest_of(record):
    """What is left of the force when its parts are taken away, N: (axes, rows)."""
    axes = [axis for axis in "xyz" if f"force_{axis}" in record]
    parts = [sum(record[f"{part}_force_{axis}"] for part in PARTS) for axis in axes]
    whole = [record[f"force_{axis}"] for axis in axes]
    return np.array(whole)[:, 1:] - np.array(parts)[:, 1:]


@pytest.mark.validate
def test_water_at_rest_presses_on_a_dam_across_a_channel(tmp_path):
    """Within 1 %; the split adds up to rounding; and nothing pushes the dam towards one bank."""
    record, exact = across_a_channel(tmp_path)
    assert record["force_x"][1:].mean() == pytest.approx(exact, rel=0.01)
    assert record["static_force_x"][1:].mean() == pytest.approx(exact, rel=0.01)
    assert np.abs(rest_of(record)).max() < 1e-9 * exact
    assert abs(record["force_y"][1:].mean()) < 0.01 * exact


def static_at_the_start(folder, bed, dp=0.04):
    """Static part of the load on a dam before water filled to DEPTH, over the exact thrust."""
    grid(folder / "terrain.asc", bed, (2.4, 2.0), 0.05)
    low = DEPTH - math.ceil((DEPTH + 0.12) / dp - 1e-9) * dp  # whole particles up to the level
    text = LAKE.replace("relax = 3.0\n", "").replace("dp = 0.04", f"dp = {dp}")
    path = folder / "case.toml"
    path.write_text(text.replace("min = [0.2, 0.1, -0.12]", f"min = [0.2, 0.1, {low}]"))
    scenario = load_scenario(path)
    simulation, names = build_simulation(scenario)
    reader = build_gauges(scenario, names)[0]
    far = np.full(3, np.inf)
    found = reader.gauge.static(simulation, reader.setting, (-far, far))
    return found[:3] / hydrostatic(scenario, DEPTH)


@pytest.mark.parametrize(("rise", "steep", "fall"), [
    (0.0, 1.0, 0.1), (0.01, 1.0, 0.1), (0.02, 1.0, 0.1), (0.0, 0.5, 0.1), (0.0, 2.0, 0.1),
    (0.0, 1.0, 0.0), (0.0, 1.0, 0.5),
])  # fmt: skip
def test_the_static_part_counts_what_the_ground_leaves_of_a_cell(tmp_path, rise, steep, fall):
    """Within 1.5 % at 10 over the depth, wherever bed and banks cut the particles of the dam."""

    def bed(x, y):
        banks = steep * np.maximum(np.abs(y - 1.0) - 0.2, 0.0)
        return rise - fall * (x - FACE) + banks + np.maximum(0.7 - x, 0.0)

    along, across, up = static_at_the_start(tmp_path, bed)
    assert along == pytest.approx(1.0, rel=0.015)
    assert abs(across) < 0.001
    assert abs(up) < 0.001


@pytest.mark.validate
def test_with_the_ground_inside_the_dam_it_misses_a_part(tmp_path):
    """The control: what is yet to move does not make room in the ground, which bears the rest."""
    moving = LAKE + "[body.dam.motion]\nvelocity = [1, 0, 0]\nstart = 9\n"
    record, exact = across_a_channel(tmp_path, moving.replace("relax = 3.0", "relax = 0.4"))
    assert record["force_x"][1:].mean() < 0.96 * exact


# A basin on a map between walls that are turned about the foot of the dam; the bed falls to it.
BASIN = """
dim = 3
dp = "= 0.4/particles"
time_max = 0.25
time_out = 0.25
scheme = "resolved"
gravity = [0, 0, -9.81]
speed_max = 2.0
relax = 2.0
[parameters]
particles = {{ value = {particles} }}
[terrain]
file = "terrain.asc"
material = "basalt"
wall = "free_slip"
[body.back]
{wall}normal = [1, 0, 0]
min = ["= 0.4 - 4*dp", "= 1 - 4*dp", "= -5*dp"]
max = [0.4, "= 1.4 + 4*dp", "= 0.4 + 3*dp"]
[body.right]
{wall}normal = [0, 1, 0]
min = [0.4, "= 1 - 4*dp", "= -5*dp"]
max = [1.0, 1.0, "= 0.4 + 3*dp"]
[body.left]
{wall}normal = [0, -1, 0]
min = [0.4, 1.4, "= -5*dp"]
max = [1.0, "= 1.4 + 4*dp", "= 0.4 + 3*dp"]
[body.dam]
{wall}normal = [-1, 0, 0]
min = [1.0, "= 1 - 4*dp", "= -5*dp"]
max = ["= 1 + 4*dp", "= 1.4 + 4*dp", "= 0.4 + 3*dp"]
[body.lake]
shape = "box"
material = "water"
min = [0.4, 1.0, 0]
max = [1.0, 1.4, 0.4]
rotate = {angle}
rotate_axis = [0, 0, 1]
pivot = [1, 1.2, 0]
pressure = "= 9810*(0.4 - z)"
[gauge.dam]
kind = "load"
bodies = ["dam"]
interval = 0.02
[gauge.level]
kind = "surface_height"
position = [{middle}, 0.1]
interval = 0.02
"""
WALL = """shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
rotate = {angle}
rotate_axis = [0, 0, 1]
pivot = [1, 1.2, 0]
"""


def still_thrust(level, c=20.0):
    """Force of still water with the sound speed `c` (10 speed_max) on a wall, N/m.

    From dp/dz = -rho g and p = c^2 (rho - rho0): water that gives way presses 0.3 % harder here.
    """
    return 1000 * c**2 * (c**2 / G * math.expm1(G * level / c**2) - level)


def in_a_basin(folder, angle, slope, particles):
    """Force across and along the dam, over the thrust at the level that the water has."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))

    def bed(x, y):
        return slope * np.maximum(-((x - 1) * c + (y - 1.2) * s), 0.0)

    grid(folder / "terrain.asc", bed, (2.4, 2.4), 0.05)
    middle = f"{1 - 0.3 * c}, {1.2 - 0.3 * s}"
    wall = WALL.format(angle=angle)
    path = folder / "case.toml"
    path.write_text(BASIN.format(angle=angle, particles=particles, wall=wall, middle=middle))
    run_scenario(load_scenario(path), folder / "run", RunOptions(threads=1))
    gauges = load(folder / "run").gauges
    level = 0.1 + float(gauges["level"]["height"][1:].mean())
    exact = still_thrust(level) * 0.4
    x, y = (gauges["dam"][f"force_{axis}"][1:].mean() for axis in "xy")
    return (x * c + y * s) / exact, (y * c - x * s) / exact


@pytest.mark.validate
@pytest.mark.parametrize(("angle", "slope", "particles"), [(0, 0, 16), (30, 0, 16), (30, 0.2, 28)])
def test_a_dam_oblique_to_the_map_bears_the_same(tmp_path, angle, slope, particles):
    """Within 1 %, turned by any angle to the axes of the map, also on a bed that falls to it.

    There the row in the corner at the foot bears less: 1.3 % short with 16 particles over the
    depth, 1.0 % with 24.
    """
    across, along = in_a_basin(tmp_path, angle, slope, particles)
    assert across == pytest.approx(1.0, rel=0.01)
    assert abs(along) < 0.01


# The same in 2-D on a level bed, 40 over the depth.
POOL = """
[body.back]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [1, 0]
min = [-0.04, -0.04]
max = [0, 0.52]
[body.dam]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [-1, 0]
min = [0.4, -0.04]
max = [0.52, 0.52]
[material.water]
rho0 = {rho}
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.4]
pressure = "= {rho}*9.81*(0.4 - y)"
[gauge.dam]
kind = "load"
bodies = ["dam"]
interval = 0.02
"""


def thrust(folder, rho):
    """Mean force and its static part, over that of water."""
    profile(folder / "terrain.csv", lambda x: 0 * x, -0.5, 1.5)
    path = folder / "case.toml"
    path.write_text(text(2, dp=0.01, time=0.3, speed=2.0, more=POOL.format(rho=rho)))
    run_scenario(load_scenario(path), folder / "run", RunOptions(threads=1))
    record = load(folder / "run").gauges["dam"]
    exact = 0.5 * 1000 * G * DEPTH**2
    assert np.abs(rest_of(record)).max() < 1e-9 * exact
    return [record[f"{part}force_x"][1:].mean() / exact for part in ("", "static_")]


@pytest.mark.minutes
def test_water_at_rest_presses_on_a_dam_in_two_dimensions(tmp_path):
    assert thrust(tmp_path, 1000) == pytest.approx([1.0, 1.0], rel=0.01)


@pytest.mark.minutes
def test_heavier_water_is_told_apart(tmp_path):
    """The control: 3 % heavier."""
    assert min(thrust(tmp_path, 1030)) > 1.015
