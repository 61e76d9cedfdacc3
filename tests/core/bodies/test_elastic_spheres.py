"""Elastic bodies in space touch with smooth surfaces, whichever way their points lie."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

RADIUS = 0.05
SPEED = 0.5
YOUNG = 1e7
TOP = """
schema = 1
dim = 3
dp = {dp}
scheme = "resolved"
speed_max = 1
time_max = 1
time_out = 1
gravity = [0, 0, 0]

[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 90
young_modulus = 1e7
poisson_ratio = 0.3
friction = {friction}
"""
BODY = """
[body.{name}]
shape = "{shape}"
material = "rubber"
kinematics = "elastic"
velocity = {velocity}
{place}
"""
FLOOR = """
[body.floor]
shape = "box"
material = "rubber"
fixed = true
min = [-0.15, -0.15, -0.1]
max = [0.15, 0.15, 0]
{turn}
"""


def turning(axis, angle):
    """The matrix that turns about an axis by degrees."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    t = np.radians(angle)
    return np.eye(3) + np.sin(t) * across + (1 - np.cos(t)) * across @ across


TURNS = [((0, 0, 1), 0.0), ((1, 2, 3), 37.0), ((3, -1, 1), 70.0)]


def sphere(name, place, velocity):
    place = f"centre = {list(map(float, place))}\nradius = {RADIUS}"
    return BODY.format(name=name, shape="sphere", velocity=list(map(float, velocity)), place=place)


@pytest.fixture
def run(tmp_path: Path):
    """Momentum and spin over the mass of each body before and after `time`."""

    def motions(tables, across=10, friction=0.0, time=0.01):
        path = tmp_path / "case.toml"
        top = TOP.format(dp=2 * RADIUS / across, friction=friction)
        path.write_text(top + tables, encoding="utf-8")
        simulation, names = build_simulation(load_scenario(str(path)))
        before = simulation.state()
        simulation.advance(limit=time, pause=time, max_steps=10**9)
        moving = [name for name in "ab" if name in names]
        return [
            {name: motion(state, state["body"] == names.index(name)) for name in moving}
            for state in (before, simulation.state())
        ]

    return motions


def motion(state, mine):
    """Velocity, spin, and momentum about the origin over the mass, of the particles of a body."""
    position, velocity = state["position"][mine], state["velocity"][mine]
    centre, drift = position.mean(axis=0), velocity.mean(axis=0)
    arm = position - centre
    turn = np.cross(arm, velocity - drift).mean(axis=0) / (2 / 3 * (arm**2).sum(1).mean())
    return drift, turn, np.cross(position, velocity).mean(axis=0)


def meeting(turn, offset=0.0):
    """Two spheres that meet along a line turned against their lattices, off it by `offset` R."""
    along, aside = turn @ [0, 0, 1], turn @ [1, 0, 0]
    place = (RADIUS + 2e-4) * along + offset * RADIUS * aside
    return sphere("a", place, -SPEED * along) + sphere("b", -place, SPEED * along)


@pytest.mark.parametrize("turn", TURNS)
def test_smooth_spheres_neither_turn_nor_swerve(run, turn):
    """As balls of bare points they swerved by 0.14 of their speed and turned by 0.34."""
    matrix = turning(*turn)
    before, after = run(meeting(matrix))
    velocity = matrix.T @ after["a"][0]
    assert np.abs(velocity[:2]).max() < 0.005 * SPEED
    assert np.linalg.norm(after["a"][1]) * RADIUS < 0.012 * SPEED
    assert velocity[2] == pytest.approx(0.997 * SPEED, rel=0.003)
    for k in (0, 2):  # momentum and angular momentum
        kept = sum(after[name][k] - before[name][k] for name in "ab")
        assert np.abs(kept).max() < 1e-12
