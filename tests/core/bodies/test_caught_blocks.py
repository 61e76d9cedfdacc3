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


def pressed(folder, own: float):
    """The largest load of a square block that is pressed between two rollers and a third, N/m.

    Its own axes are turned by a quarter turn, or not: which of them is across the load is alike.
    """
    half, steel = 0.5 * HIGH, '"aluminium"'
    text = TEXT.format(dp=HIGH / 12).replace("speed = 1", 'stiffness = "material"') + box(
        "block", (-half, 0), (half, HIGH), material='"rock"', kinematics='"breakable"', rotate=own
    )  # fmt: skip
    for side in (-1, 1):
        text += ball(f"roller{side + 1}", (side * (half - POST), -POST), POST, fixed=True)
    text += ball("press", (0, HIGH + POST), POST, fixed=True, motion="{ velocity = [0, -0.04] }")
    simulation = started(folder, text.replace('"stone"', steel)).simulation
    most = 0.0
    for time in np.linspace(0, 0.01, 101)[1:]:
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        forces = np.linalg.norm(simulation.grains()["contact_force"], axis=1)
        most = max(most, forces.max())
        if simulation.totals()["broken_bonds"] > 10:
            return most
    return np.inf


@pytest.mark.parametrize("own", [0, 90])
def test_a_block_that_is_pressed_breaks_at_the_load_of_an_elastic_one(tmp_path, own):
    """Which is 306 kN/m; as a disc of its area, Eq. (139b), it was rigid up to 705."""
    assert 0.8 * 306e3 < pressed(tmp_path, own) < 1.25 * 306e3


@pytest.mark.parametrize("turn", [0, 40])
def test_what_slides_with_a_load_on_it_is_not_struck(tmp_path, turn):
    """Friction makes no blow: both slide down at 5 m/s, pressed on their way by their weight."""
    angle = np.radians(turn)
    along, up = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    weight = listed(-9.81 * (0.9 * up - 0.3 * along))
    turned = {"rotate": turn, "pivot": [0.0, 0.0]}
    text = TEXT.format(dp=HIGH / 10).replace("[0.0, 0.0]", str(weight), 1)
    moving = {"material": '"rock"', "velocity": listed(5 * along), **turned}
    text += box("slope", (-1, -0.1), (2, 0), fixed=True, material='"basalt"', **turned)
    text += box("below", (-0.1, 0), (0.1, 0.1), kinematics='"breakable"', **moving)
    text += box("above", (-0.1, 0.1), (0.1, 0.2), **moving)
    simulation = started(folder=tmp_path, text=text).simulation
    for time in np.linspace(0, 0.1, 21)[1:]:
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        assert len(simulation.fragments()["mass"]) == 0


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
