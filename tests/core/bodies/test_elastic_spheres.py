"""Elastic bodies in space touch with smooth surfaces, whichever way their points lie."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.lattices import rotation_matrix
from doseki.solver.build import build_simulation

RADIUS = 0.05
SPEED = 0.5
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


TURNS = [((0, 0, 1), 0.0), ((1, 2, 3), 37.0), ((3, -1, 1), 70.0)]  # axis, degrees


def turning(turn):
    axis, degrees = turn
    return rotation_matrix(degrees, 3, np.array(axis, float))


def sphere(name, place, velocity):
    place = f"centre = {list(map(float, place))}\nradius = {RADIUS}"
    return BODY.format(name=name, shape="sphere", velocity=list(map(float, velocity)), place=place)


def floor(axis, angle):
    """Its top is the plane through the origin that is at right angles to the turned z."""
    turn = f"pivot = [0, 0, 0]\nrotate_axis = {list(axis)}\nrotate = {angle}"
    return FLOOR.format(turn=turn if angle else "")


class Motion(NamedTuple):
    """Of a body, by its particles; momentum about the origin is over its mass."""

    centre: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    about_origin: np.ndarray


def motion(state, mine):
    position, velocity = state["position"][mine], state["velocity"][mine]
    centre, drift = position.mean(axis=0), velocity.mean(axis=0)
    arm = position - centre
    spin = np.cross(arm, velocity - drift).mean(axis=0) / (2 / 3 * (arm**2).sum(1).mean())
    return Motion(centre, drift, spin, np.cross(position, velocity).mean(axis=0))


@pytest.fixture
def run(tmp_path: Path):
    """How each body of these moves at the start and at some `times` after it."""

    def motions(tables, across=10, friction=0.0, times=(0.01,)):
        path = tmp_path / "case.toml"
        top = TOP.format(dp=2 * RADIUS / across, friction=friction)
        path.write_text(top + tables, encoding="utf-8")
        simulation, names = build_simulation(load_scenario(str(path)))
        moving = [name for name in "ab" if name in names]
        found = []
        for time in (0.0, *times):
            simulation.advance(limit=time, pause=time, max_steps=10**9)
            state = simulation.state()
            found.append(
                {name: motion(state, state["body"] == names.index(name)) for name in moving}
            )
        return found

    return motions


def meeting(turn, offset=0.0):
    """Two spheres on ways `offset` radii apart, along a line turned against their lattices."""
    along, aside = turn @ [0, 0, 1], turn @ [1, 0, 0]
    place = RADIUS * (np.sqrt(1 - 0.25 * offset**2) * along + 0.5 * offset * aside) + 2e-4 * along
    return sphere("a", place, -SPEED * along) + sphere("b", -place, SPEED * along)


def kept(before, after):
    """What the pair gained of momentum and angular momentum, at most, over the mass of one."""
    gained = [sum(np.array(after[k][n]) - before[k][n] for k in "ab") for n in (1, 3)]
    return np.abs(gained).max()


@pytest.mark.parametrize("turn", TURNS)
def test_smooth_spheres_neither_turn_nor_swerve(run, turn):
    """As balls of bare points they swerved by 0.14 of their speed and turned by 0.34."""
    matrix = turning(turn)
    before, after = run(meeting(matrix))
    velocity = matrix.T @ after["a"].velocity
    assert np.abs(velocity[:2]).max() < 0.005 * SPEED
    assert np.linalg.norm(after["a"].spin) * RADIUS < 0.012 * SPEED
    assert velocity[2] == pytest.approx(0.997 * SPEED, rel=0.003)
    assert kept(before, after) < 1e-12


@pytest.mark.parametrize("turn", TURNS[:2])
@pytest.mark.parametrize(("offset", "friction"), [(0.5, 0.0), (1.4, 0.1)])
def test_spheres_that_slide_push_aside_by_friction_alone(run, turn, offset, friction):
    """Off their line of centres, which turns while they touch; of slow ones they would roll."""
    matrix = turning(turn)
    motions = run(meeting(matrix, offset), friction=friction, times=np.arange(1, 131) * 1e-4)
    line = np.array([at["a"].centre - at["b"].centre for at in motions])
    line = line[1:] + line[:-1]
    line /= np.linalg.norm(line, axis=1)[:, None]
    push = np.diff([at["a"].velocity for at in motions], axis=0)
    normal = matrix @ [0, 1, 0]  # of the plane in which they move
    pressed, aside = (push * line).sum(), (push * np.cross(line, normal)).sum()
    assert pressed > 0.7 * SPEED
    assert aside / pressed == pytest.approx(friction, abs=0.002)
    assert abs((push @ normal).sum()) < 0.002 * pressed
    spin = 2.5 * friction * pressed  # of a ball that the friction turns
    assert motions[-1]["a"].spin @ normal * RADIUS == pytest.approx(spin, abs=0.02 * SPEED)
    assert kept(motions[0], motions[-1]) < 1e-12


@pytest.mark.parametrize("turn", TURNS)
def test_a_sphere_goes_straight_back_from_a_plane(run, turn):
    matrix = turning(turn)
    up = matrix @ [0, 0, 1]
    falling = sphere("a", (RADIUS + 2e-4) * up, -SPEED * up)
    after = run(floor(*turn) + falling, times=(0.0125,))[-1]["a"]
    assert after.velocity @ up == pytest.approx(0.998 * SPEED, rel=0.002)
    assert np.linalg.norm(after.velocity - after.velocity @ up * up) < 1e-9
    assert np.linalg.norm(after.spin) * RADIUS < 0.015 * SPEED


@pytest.mark.full
def test_a_cube_that_falls_on_its_face_does_not_turn(run):
    half = RADIUS
    place = f"min = [-{half}, -{half}, 2e-4]\nmax = [{half}, {half}, {2 * half + 2e-4}]"
    cube = BODY.format(name="a", shape="box", velocity=[0.0, 0.0, -SPEED], place=place)
    after = run(floor(*TURNS[0]) + cube, times=(0.005,))[-1]["a"]
    assert after.velocity[2] > 0.8 * SPEED
    assert np.abs(after.velocity[:2]).max() < 1e-9
    assert np.abs(after.spin).max() * RADIUS < 1e-9
