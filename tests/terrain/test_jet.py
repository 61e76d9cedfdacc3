"""A steady jet down a map onto a dam: the force is the momentum that it brings, rho Q v."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from .scenes import grid

SPEED, THICK = 2.0, 0.1  # m/s, m
PARTS = ("static", "dynamic", "contact")
# There is no gravity. The inflow is six thicknesses away: from nearer it would push against the
# pressure before the dam.
SCENE = """
dim = {dim}
dp = {dp}
time_max = {time}
time_out = {time}
scheme = "resolved"
gravity = {gravity}
speed_max = 4.0
[terrain]
file = "terrain.asc"
material = "basalt"
wall = "free_slip"
{section}
[inflow.jet]
material = "water"
rate = {rate}
duration = 100
width = {width}
depth = 0.1
position = {position}
direction = {direction}
[body.dam]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
min = {low}
max = {high}
rotate = {turn}
{axis}
pivot = {foot}
[gauge.dam]
kind = "load"
bodies = ["dam"]
interval = 0.01
"""
OUTFLOW = """
[outflow.above]
min = [-9, 0.6]
max = [9, 9]
"""


def force_on_dam(folder, scene, late):
    """Mean force (dim,) after the time `late`, s; its parts add up to it."""
    path = folder / "case.toml"
    path.write_text(scene)
    run_scenario(load_scenario(path), folder / "run", RunOptions(threads=1))
    record = load(folder / "run").gauges["dam"]
    force = []
    for axis in [axis for axis in "xyz" if f"force_{axis}" in record]:
        whole = record[f"force_{axis}"]
        parts = sum(record[f"{part}_force_{axis}"] for part in PARTS)
        assert np.abs(whole - parts)[1:].max() < 1e-9 * 400
        force.append(whole[record["time"] > late].mean())
    return np.array(force)


def jet(folder, speed=SPEED, tilt=20.0, sign=1):
    """Force along the bed and across it in 2-D, over rho v2 b at SPEED.

    The section of the map is taken from its other end for a `sign` of -1: the jet goes to -x.
    """
    cos, sin = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    grid(folder / "terrain.asc", lambda x, y: -sin / cos * (x - 1.35), (2.4, 1.0), 0.05)
    ends = [[0.3, 0.5], [2.2, 0.5]][::sign]
    foot = 1.05 if sign > 0 else 0.85
    low, high = sorted((foot, foot + 0.09 * sign))
    scene = SCENE.format(
        dim=2, dp=0.01, time=0.9, gravity=[0, 0], section=f"section = {ends}", rate=THICK * speed,
        width=1, position=[foot - sign * 0.65 * cos, 0.65 * sin], direction=[sign * cos, -sin],
        low=[low, -0.04], high=[high, 0.9], turn=-sign * tilt, axis="", foot=[foot, 0],
    )  # fmt: skip
    x, y = force_on_dam(folder, scene + OUTFLOW, 0.6) / (1000 * SPEED**2 * THICK)
    return np.array([sign * x * cos - y * sin, sign * x * sin + y * cos])


@pytest.mark.validate
@pytest.mark.parametrize(("tilt", "sign"), [(20.0, 1), (20.0, -1), (35.0, 1)])
def test_a_jet_along_the_bed_loses_its_momentum_at_a_dam(tmp_path, tilt, sign):
    """Within 3 %, on another slope and the other way round."""
    along, across = jet(tmp_path, tilt=tilt, sign=sign)
    assert along == pytest.approx(1.0, rel=0.03)
    assert abs(across) < 0.03


@pytest.mark.validate
def test_a_faster_jet_is_told_apart(tmp_path):
    """The control: a twentieth more speed."""
    assert jet(tmp_path, 1.05 * SPEED)[0] > 1.06


def jet_in_space(folder, angle, speed=SPEED, particles=5, time=0.65):
    """Force along the jet, across the bed and sideways in 3-D, over rho Q v at SPEED.

    The jet is 0.1 m by 0.1 m and goes down a slope of 20 degrees, `angle` degrees from x in plan.
    """
    plan, tilt = math.radians(angle), math.radians(20.0)
    down = np.array([math.cos(plan), math.sin(plan), -math.tan(tilt)]) * math.cos(tilt)
    aside = np.array([-math.sin(plan), math.cos(plan), 0.0])
    up = np.cross(down, aside)
    foot, dp = np.array([1.2, 1.2, 0.0]), THICK / particles
    grid(
        folder / "terrain.asc",
        lambda x, y: -math.tan(tilt) * ((x - 1.2) * math.cos(plan) + (y - 1.2) * math.sin(plan)),
        (2.4, 2.4), 0.05,
    )  # fmt: skip
    turn = Rotation.from_matrix(np.column_stack([down, aside, up])).as_rotvec()
    angle_of_turn = float(np.linalg.norm(turn))
    low, high = foot + np.array([[0.0, -0.4, -4 * dp], [5 * dp, 0.4, 0.5]])
    scene = SCENE.format(
        dim=3, dp=dp, time=time, gravity=[0, 0, 0], section="", rate=THICK * THICK * speed,
        width=THICK, position=(foot - 0.6 * down - 0.05 * aside).tolist(),
        direction=down.tolist(), low=low.tolist(), high=high.tolist(),
        turn=math.degrees(angle_of_turn),
        axis=f"rotate_axis = {(turn / angle_of_turn).tolist()}", foot=foot.tolist(),
    )  # fmt: skip
    force = force_on_dam(folder, scene, 0.45) / (1000 * SPEED**2 * THICK**2)
    return force @ np.column_stack([down, up, aside])


@pytest.mark.validate
@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_a_jet_in_space_loses_its_momentum_at_a_dam(tmp_path, angle):
    """Within 3 %, along the axes of the map and oblique to them."""
    along, across, aside = jet_in_space(tmp_path, angle)
    assert along == pytest.approx(1.0, rel=0.03)
    assert abs(across) < 0.03
    assert abs(aside) < 0.01


@pytest.mark.validate
def test_a_faster_jet_in_space_is_told_apart(tmp_path):
    """The control: a twentieth more speed."""
    assert jet_in_space(tmp_path, 0.0, 1.05 * SPEED)[0] > 1.06
