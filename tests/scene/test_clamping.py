"""Clamped bodies: what holds them may overlap them, and an expression that holds all or nothing."""

from __future__ import annotations

import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.checks.bodies.clamping import HoldsNone
from doseki.scene.checks.particle_overlaps import Overlap
from doseki.solver.build import filled_simulation

WALL = """
schema = 1
dim = 2
dp = 0.05
scheme = "resolved"
speed_max = 5
time_max = 0.1
time_out = 0.1
gravity = [0, -9.81]
[material.rubber]
law = "solid"
rho0 = 1100
young_modulus = 1e7
poisson_ratio = 0.4
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-1, -0.3]
max = [1, 0]
[body.wall]
shape = "{shape}
material = "rubber"
kinematics = "elastic"
clamped = "{clamped}"
"""
BOX = 'box"\nmin = [0, -0.2]\nmax = [0.2, 0.6]'
POLYGON = 'polygon"\nvertices = [[0, -0.2], [0.2, -0.2], [0.2, 0.6], [0, 0.6]]'


def doubts(folder, clamped, shape=BOX):
    """What is said of a wall of 64 points, of which 16 lie in the floor."""
    path = folder / "wall.toml"
    path.write_text(WALL.format(clamped=clamped, shape=shape), encoding="utf-8")
    found = filled_simulation(load_scenario(str(path))).warnings
    return [each for each in found if isinstance(each, (HoldsNone, Overlap))]


@pytest.mark.parametrize("shape", [BOX, POLYGON])
def test_a_foot_in_what_holds_it_overlaps_nothing(tmp_path, shape):
    assert doubts(tmp_path, "= -y", shape) == []


def test_points_that_are_not_held_overlap_as_ever(tmp_path):
    (found,) = doubts(tmp_path, "= -0.1 - y")
    assert isinstance(found, Overlap)
    assert (found.place, found.other, found.pairs) == ("floor", "wall", 8)


@pytest.mark.parametrize(
    ("clamped", "said"),
    [
        ("= y - 100", "holds none of its 64 points, at which it is from -100.2 to -99.42"),
        ("= 10 - y", "holds all of its 64 points, at which it is from 9.425 to 10.18, so that"),
    ],
)
def test_what_holds_nothing_or_everything_is_told(tmp_path, clamped, said):
    told = [str(each) for each in doubts(tmp_path, clamped) if isinstance(each, HoldsNone)]
    assert len(told) == 1
    assert f"wall: clamped {said}" in told[0]


WATER = """
[body.water]
shape = "{shape}
material = "water"
"""


@pytest.mark.parametrize(
    "shape",
    ['polygon"\nvertices = [[0, 1], [1, 1], [1, 2]]', 'disc"\nd = 0.2\nmin = [0, 1]\nmax = [1, 2]'],
)
def test_a_fluid_is_told_which_shapes_it_may_have(tmp_path, shape):
    """The scheme is resolved, so that is not what is wrong."""
    path = tmp_path / "water.toml"
    path.write_text(WALL.format(clamped="= -y", shape=BOX) + WATER.format(shape=shape))
    with pytest.raises(UserError, match=r'is for solids, and water is a fluid: .*"box"') as refused:
        load_scenario(str(path))
    assert "set scheme" not in str(refused.value)


@pytest.mark.parametrize(
    "shape",
    [
        'box"\nmin = [0, 1]\nmax = [1, 2]\nwhere = "= x - y + 1"',
        'box"\nmin = [0, 1]\nmax = [1, 2]\nrotate = 10',
        'disc"\ncentre = [0, 1]\nradius = 0.3',
        'points"\nposition = [[0, 1]]\nmass = 1',
    ],
)
def test_those_it_may_have(tmp_path, shape):
    path = tmp_path / "water.toml"
    path.write_text(WALL.format(clamped="= -y", shape=BOX) + WATER.format(shape=shape))
    assert len(filled_simulation(load_scenario(str(path))).simulation) > 0
