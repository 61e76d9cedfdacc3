"""Elastic bodies touch with smooth surfaces: which way their points lie does not matter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

RADIUS = 0.05
TOP = """
schema = 1
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 2
time_max = 1
time_out = 1
gravity = [0, 0]

[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 90
young_modulus = 1e7
poisson_ratio = 0.3
"""
DISC = """
[body.{name}]
shape = "disc"
material = "rubber"
kinematics = "{kind}"
centre = [{x}, {y}]
radius = 0.05
velocity = [{u}, {v}]
rotate = {angle}
"""
WALL = """
[body.wall]
shape = "box"
material = "rubber"
fixed = true
min = [0.0501, -0.2]
max = [0.0701, 0.2]
"""
HALF = """
[body.{name}]
shape = "box"
material = "rubber"
kinematics = "elastic"
min = [{x}, {y}]
max = [{right}, {top}]
velocity = [{u}, 0]
"""


@pytest.fixture
def run(tmp_path: Path):
    """The states of bodies "a" and "b", where there is one, before and after 6 ms."""

    def states(tables, friction=0.0):
        path = tmp_path / "case.toml"
        path.write_text(TOP + f"friction = {friction}\n" + tables, encoding="utf-8")
        simulation, names = build_simulation(load_scenario(str(path)))
        before = simulation.state()
        simulation.advance(limit=0.006, pause=0.006, max_steps=10**9)
        return [
            {body: of(state, names.index(body)) for body in "ab" if body in names}
            for state in (before, simulation.state())
        ]

    return states


def of(state, body):
    """The particles of a body."""
    mine = state["body"] == body
    return {key: state[key][mine] for key in ("mass", "position", "velocity")}


def momentum(part):
    """Of particles."""
    return part["mass"] @ part["velocity"]


def spin(part, about=None):
    """Angular momentum of particles about their centre, or a point."""
    x, v = part["position"], part["velocity"]
    arm = x - (x.mean(axis=0) if about is None else about)
    own = v - (v.mean(axis=0) if about is None else 0.0)
    return float(part["mass"] @ (arm[:, 0] * own[:, 1] - arm[:, 1] * own[:, 0]))


def oblique(run, angles=(0.0, 0.0), friction=0.0, mirror=1.0, kind="elastic"):
    """Impulse and spin gained by two discs that meet off the line of centres, and what is lost."""
    tables = "".join(
        DISC.format(
            name=name, kind=way, x=x, y=y * mirror, u=u, v=0.1 * mirror, angle=angle * mirror
        )
        for name, way, x, y, u, angle in (
            ("a", "elastic", -0.045, -0.025, 0.5, angles[0]),
            ("b", kind, 0.045, 0.025, -0.5, angles[1]),
        )
    )
    before, after = run(tables, friction)
    total = [sum(momentum(state[name]) for name in "ab") for state in (before, after)]
    turning = [sum(spin(state[name], 0.0) for name in "ab") for state in (before, after)]
    impulse = momentum(after["a"]) - momentum(before["a"])
    turns = [spin(after[name]) - spin(before[name]) for name in "ab"]
    lost = np.abs(total[1] - total[0]).max(), abs(turning[1] - turning[0])
    return impulse, np.array(turns) / (RADIUS * np.linalg.norm(impulse)), lost


@pytest.mark.parametrize("angles", [(0, 0), (3, -4), (1.3, 5.2)])
def test_without_friction_discs_are_not_turned(run, angles):
    """At 20 across."""
    impulse, turns, lost = oblique(run, angles)
    assert np.linalg.norm(impulse) > 3
    assert np.abs(turns).max() < 0.005
    assert max(lost) < 1e-12


def test_friction_turns_them_and_keeps_momenta(run):
    _, turns, lost = oblique(run, (3, -4), friction=0.2)
    assert 0.1 < turns.min() < turns.max() <= 0.21  # slides throughout
    assert max(lost) < 1e-12


def test_the_mirror_image_is_the_mirror_image(run):
    one, other = (oblique(run, (2, 5), friction=0.2, mirror=side) for side in (1.0, -1.0))
    # To what steps of time leave, whose length rounding changes.
    np.testing.assert_allclose(one[0] * [1, -1], other[0], rtol=1e-4)
    np.testing.assert_allclose(one[1], -other[1], rtol=1e-4)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_an_elastic_and_a_rigid_disc(run, friction):
    impulse, turns, lost = oblique(run, (3, 0), friction, kind="rigid")
    assert np.linalg.norm(impulse) > 3
    assert lost[0] < 1e-12
    assert (np.abs(turns).max() < 0.005) == (friction == 0.0)


@pytest.mark.parametrize("angle", [0, 4, 17])
def test_a_smooth_wall_takes_nothing_along_itself(run, angle):
    disc = DISC.format(name="a", kind="elastic", x=0, y=0, u=0.5, v=0.5, angle=angle)
    before, after = run(disc + WALL)
    impulse = momentum(after["a"]) - momentum(before["a"])
    assert impulse[0] < -1.9 * 0.5 * before["a"]["mass"].sum() * 0.9
    assert abs(impulse[1]) < 1e-9
    assert abs(spin(after["a"])) < 0.005 * RADIUS * abs(impulse[0])


@pytest.mark.parametrize("shift", [0.0, 0.0013, 0.02])
def test_faces_of_boxes_meet_flat(run, shift):
    """Wherever their points lie; the faces are longer than what they meet, and have corners."""
    tables = HALF.format(name="a", x=-0.0501, y=0.0, right=-0.0001, top=0.04, u=0.5)
    tables += HALF.format(name="b", x=0.0001, y=shift, right=0.0501, top=0.04 + shift, u=-0.5)
    before, after = run(tables)
    gained = momentum(after["a"]) - momentum(before["a"])
    assert gained[0] < -1.2  # of 2
    assert np.abs(gained[1]) < 0.05 * np.abs(gained[0])
    total = [sum(momentum(state[name]) for name in "ab") for state in (before, after)]
    np.testing.assert_allclose(total[0], total[1], atol=1e-12)
    turning = [sum(spin(state[name], 0.0) for name in "ab") for state in (before, after)]
    assert turning[0] == pytest.approx(turning[1], abs=1e-13)
