"""Slender bodies that are rigid until a load may break them in bending."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import box, listed, started

STRENGTH, SPAN, HEIGHT = 1e6, 0.28, 0.08  # Pa, m, m
TEXT = """
schema = 1
dim = {dim}
dp = 0.01
scheme = "resolved"
speed_max = 1
time_max = 1
time_out = 1
gravity = {gravity}

[contact]
overlap = 0.01

[material.chalk]
law = "solid"
rho0 = 1000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0.3
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 100

[material.heavy]
based_on = "basalt"
rho0 = {density}
"""


def beam(folder, dim, share, turn):
    """A load at mid-span that bends a beam on two supports by this share of its strength."""
    width = [] if dim == 2 else [HEIGHT]
    modulus = HEIGHT**2 / 6 * np.prod(width)
    weight = share * STRENGTH * modulus * 4 / SPAN
    density = weight / 9.8 / (0.1**2 * np.prod(width))
    angle = np.radians(turn)
    gravity = [9.8 * np.sin(angle), *[0.0] * (dim - 2), -9.8 * np.cos(angle)]
    text = TEXT.format(dim=dim, gravity=listed(gravity), density=density)

    def part(name, material, x, y, **values):
        """From x[0] to x[1] and y[0] to y[1], all turned about the origin."""
        low, high = zip(x, *[(-w / 2, w / 2) for w in width], y, strict=True)
        turned = {"rotate": turn, "pivot": [0.0] * dim}
        return box(name, low, high, material=f'"{material}"', **turned, **values)

    end = SPAN / 2
    text += part("left", "basalt", (-end - 0.03, -end), (-0.05, 0), fixed=True)
    text += part("right", "basalt", (end, end + 0.03), (-0.05, 0), fixed=True)
    ends = (-end - 0.03, end + 0.03)
    text += part("beam", "chalk", ends, (0, HEIGHT), kinematics='"breakable"')
    text += part("load", "heavy", (-0.05, 0.05), (HEIGHT, HEIGHT + 0.1))
    return started(folder, text).simulation


@pytest.mark.parametrize("dim", [2, pytest.param(3, marks=pytest.mark.minutes)])
@pytest.mark.parametrize("turn", [0, 30])
def test_a_beam_under_a_heavy_load_breaks(tmp_path, dim, turn):
    """A load that comes at once bends it twice as far: one of 0.35 leaves it rigid."""
    light, heavy = (beam(tmp_path, dim, share, turn) for share in (0.35, 2.0))
    for simulation in (light, heavy):
        simulation.advance(limit=0.07, pause=0.07, max_steps=10**6)
    assert len(light.fragments()["mass"]) == 0
    assert light.totals()["broken_bonds"] == 0
    assert heavy.totals()["broken_bonds"] > 0
