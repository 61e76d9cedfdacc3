"""Bodies that are rigid until water that strikes them may break them."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import ball, box, listed, started

HEAD = """
schema = 1
dim = 2
dp = 0.004
scheme = "resolved"
speed_max = 14
time_max = 1
time_out = 1
gravity = {gravity}

[contact]
speed = 12

[material.clay]
law = "solid"
rho0 = 2000
young_modulus = 5e7
poisson_ratio = 0.2
friction = 0.5
fracture = "cohesive"
tensile_strength = {strength}
fracture_energy = {energy}
"""
LONG, HIGH, RADIUS = 0.24, 0.036, 0.04  # m
END = 0.005  # s: the jet has spread by then


def head(strength: float, gravity=(0.0, 0.0)) -> str:
    """A crack's tip is five spacings long, E G / f^2."""
    energy = 0.02 * strength**2 / 5e7
    return HEAD.format(strength=strength, energy=energy, gravity=listed(gravity))


def struck(folder, shape: str, kinematics: str, strength: float, turn: int = 0):
    """A jet of water, 4 by 8 cm, that goes down at 8 m/s, on a body that nothing holds; all turned
    by a number of quarters.
    """
    quarter = np.linalg.matrix_power(np.array([[0, -1], [1, 0]]), turn)

    def corners(low, high):
        ends = np.array([quarter @ low, quarter @ high])
        return ends.min(axis=0), ends.max(axis=0)

    values = {"material": '"clay"', "kinematics": f'"{kinematics}"'}
    if shape == "disc":
        top, text = RADIUS, ball("body", quarter @ (0.0, 0.0), RADIUS, **values)
    else:
        half = np.array((LONG / 2, HIGH / 2))
        top, text = HIGH / 2, box("body", *corners(-half, half), **values)
    jet = corners(np.array((-0.02, top + 0.01)), np.array((0.02, top + 0.09)))
    text += box("jet", *jet, material='"water"', velocity=listed(quarter @ (0.0, -8.0)))
    simulation = started(folder, head(strength) + text).simulation
    simulation.advance(limit=END, pause=END, max_steps=10**6)
    return simulation


def broken(*of) -> int:
    return int(struck(*of).totals()["broken_bonds"])


@pytest.mark.parametrize(("shape", "strength"), [("box", 4e4), ("box", 3e5), ("disc", 2e4)])
def test_a_jet_breaks_what_is_breakable_as_what_is_elastic(tmp_path, shape, strength):
    """It never did: only contacts made a body deformable."""
    elastic = broken(tmp_path, shape, "elastic", strength)
    breakable = broken(tmp_path, shape, "breakable", strength)
    assert elastic > 10
    assert breakable == pytest.approx(elastic, rel=0.3)


def test_the_direction_of_the_jet_does_not_matter(tmp_path):
    straight, turned = (broken(tmp_path, "box", "breakable", 4e4, turn) for turn in (0, 1))
    assert straight > 100
    assert turned == pytest.approx(straight, rel=0.3)


@pytest.mark.parametrize("shape", ["box", "disc"])
def test_a_jet_leaves_what_is_strong_rigid(tmp_path, shape):
    """Ten times the stress of the jet where it is stopped, rho v^2."""
    simulation = struck(tmp_path, shape, "breakable", 3e6)
    assert simulation.totals()["broken_bonds"] == 0
    assert len(simulation.fragments()["mass"]) == 0


@pytest.mark.parametrize(("shape", "strength"), [("box", 5e4), ("disc", 1e4)])
def test_still_water_leaves_a_weak_body_rigid(tmp_path, shape, strength):
    """The pressure all around it pulls at nothing; water that begins to press rings by 5 kPa."""
    values = {"material": '"clay"', "kinematics": '"breakable"'}
    body = (
        ball("body", (0.25, 0.1), RADIUS, **values)
        if shape == "disc"
        else box("body", (0.13, 0.08), (0.37, 0.116), **values)
    )
    text = head(strength, (0.0, -5.0)).replace("speed_max = 14", "speed_max = 6") + body
    text = text.replace("rho0 = 2000", "rho0 = 1000")
    text += box("floor", (-0.02, -0.02), (0.52, 0.0), fixed=True, material='"aluminium"')
    for name, x in (("left", -0.02), ("right", 0.5)):
        text += box(name, (x, 0.0), (x + 0.02, 0.6), fixed=True, material='"aluminium"')
    text += box("pool", (0.0, 0.0), (0.5, 0.5), material='"water"')
    simulation = started(tmp_path, text).simulation
    for _ in range(20):
        simulation.advance(limit=0.1, pause=0.1, max_steps=10)
        assert len(simulation.fragments()["mass"]) == 0


def test_a_weak_block_on_the_bed_of_a_pool_stays_rigid(tmp_path):
    """Its strength is half the pressure at the bed, which is below it as well from the start."""
    weak = head(2e4, (0.0, -9.81)).replace("dp = 0.004", "dp = 0.05")
    text = weak.replace("speed_max = 14", "speed_max = 9").replace("rho0 = 2000", "rho0 = 2200")
    still = 'pressure = "= 1000*9.81*(4 - y)"\n'
    text += box("pool", (0, 0), (3, 4), material='"water"') + still
    text += '[body.tank]\nshape = "tank"\nmaterial = "aluminium"\nmin = [0, 0]\nmax = [3, 4.5]\n'
    text += box("block", (1.2, 0), (1.8, 0.6), material='"clay"', kinematics='"breakable"')
    simulation = started(tmp_path, text).simulation
    for _ in range(20):
        simulation.advance(limit=0.1, pause=0.1, max_steps=5)
        assert len(simulation.fragments()["mass"]) == 0
