"""Stacks of breakable blocks, of which some become deformable within a long step."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import box, started

TEXT = """
schema = 1
dim = 2
dp = 0.0125
scheme = "resolved"
speed_max = 6
time_max = 1
time_out = 1
gravity = {gravity}

[contact]
speed = {speed}

[material.brick]
law = "solid"
rho0 = 2000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0.6
fracture = "cohesive"
tensile_strength = 2e5
fracture_energy = 30
"""
LONG, HIGH, BRICKS = 0.2, 0.1, 5
STEP, END = 0.008, 0.04  # s


@pytest.mark.parametrize("upright", [True, False])
@pytest.mark.parametrize("speed", [0.03, 0.1])
def test_a_stack_that_settles_gains_no_energy(tmp_path, speed, upright):
    """Soft contacts let it sink by some tenths of a millimetre.

    Who becomes a neighbour of what deforms was half a step of 4 ms ahead of it, and what they went
    was not counted: they met a stiff contact with the overlap of that, and 40 to 190 J/m from
    nowhere.
    """
    text = TEXT.format(speed=speed, gravity=[0, -9.81] if upright else [-9.81, 0])
    turned = (lambda x, y: (x, y)) if upright else (lambda x, y: (y, x))
    for n in range(BRICKS):
        low, high = turned(0, n * HIGH), turned(LONG, (n + 1) * HIGH)
        text += box(f"brick{n}", low, high, material='"brick"', kinematics='"breakable"')
    text += box("floor", turned(-0.5, -0.05), turned(0.7, 0), fixed=True, material='"basalt"')
    simulation = started(tmp_path, text).simulation
    given = []
    for time in np.arange(STEP, END + 0.5 * STEP, STEP):
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        given.append(simulation.totals()["contact_work"])
    falls = 2000 * LONG * HIGH * BRICKS * 9.81 * 0.0025  # J/m
    assert max(given) < 0.2 * falls
    assert simulation.totals()["broken_bonds"] == 0
