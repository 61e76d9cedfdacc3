"""Compact bodies that are rigid until what holds them, or their spin, may break them."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import ball, box, listed, started

HIGH, POST = 0.1, 0.01  # m
STRENGTH, DENSITY = 4e6, 2200.0
TEXT = """
schema = 1
dim = 2
dp = {dp}
scheme = "resolved"
speed_max = 2
time_max = 1
time_out = 1
gravity = [0.0, 0.0]

[contact]
speed = 1

[material.rock]
law = "solid"
rho0 = 2200
young_modulus = 14e9
poisson_ratio = 0.2
friction = 0.4
fracture = "cohesive"
tensile_strength = 4e6
fracture_energy = 20
"""


def broken(text: str, folder, end: float):
    simulation = started(folder, text).simulation
    simulation.advance(limit=end, pause=end, max_steps=10**6)
    return simulation.totals()["broken_bonds"]


def caught(folder, kinematics: str, long: float, speed: float, turn: float = 0.0):
    """Bonds that break in a block `long` times as long as high, on two posts, on which a boulder of
    twenty times its mass lands; all turned, degrees.
    """
    angle = np.radians(turn)
    along, up = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    half = 0.5 * long * HIGH
    text = TEXT.format(dp=HIGH / 12) + box(
        "block", (-half, 0), (half, HIGH), material='"rock"', kinematics=f'"{kinematics}"',
        rotate=turn, pivot=[0.0, 0.0],
    )  # fmt: skip
    for side in (-1, 1):
        post = side * (half - POST) * along - POST * up
        text += ball(f"post{side + 1}", post, POST, fixed=True, material='"aluminium"')
    text += ball(
        "boulder", (HIGH + 0.3001) * up, 0.3, material='"basalt"', velocity=listed(-speed * up)
    )
    return broken(text, folder, 0.004)


@pytest.mark.parametrize(("long", "turn"), [(1.0, 0), (1.4, 0), (1.4, 30)])
def test_a_block_between_posts_and_a_boulder_breaks_as_an_elastic_one(tmp_path, long, turn):
    """By far less than the plane wave of their speed, Eq. (139a): the boulder goes on."""
    assert caught(tmp_path, "elastic", long, 0.35, turn) > 10
    assert caught(tmp_path, "breakable", long, 0.35, turn) > 10


def test_one_that_stays_rigid_would_not_have_cracked(tmp_path):
    assert caught(tmp_path, "breakable", 1.4, 0.1) == 0
    assert caught(tmp_path, "elastic", 1.4, 0.1) == 0


def spun(folder, kinematics: str, share: float):
    """Bonds that break in a rod whose spin pulls at its middle by a share of its strength."""
    spin = np.sqrt(8 * STRENGTH * share / DENSITY) / 0.1
    text = TEXT.format(dp=0.0025) + box(
        "rod", (-0.05, -0.01), (0.05, 0.01), material='"rock"', kinematics=f'"{kinematics}"',
        spin=spin,
    )  # fmt: skip
    return broken(text, folder, 0.001)


def test_what_spins_too_fast_breaks(tmp_path):
    assert spun(tmp_path, "elastic", 1.5) > 10
    assert spun(tmp_path, "breakable", 1.5) > 10
    assert spun(tmp_path, "breakable", 0.9) == 0
    # One that gets its spin at once is pulled twice as hard for a moment.
    assert spun(tmp_path, "elastic", 0.45) == 0
