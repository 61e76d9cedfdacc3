"""Slender bodies that are rigid until a load may break them in bending."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

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
BOX = """
[body.{name}]
shape = "box"
material = "{material}"
min = {low}
max = {high}
rotate = {turn}
{pivot}
{more}
"""
BREAKABLE = 'kinematics = "breakable"'


def box(name, material, x, y, width, turn, more=""):
    """From x[0] to x[1] and y[0] to y[1], in 3-D as wide as this, all turned about the origin."""
    aside = [] if width is None else [(-width / 2, width / 2)]
    low, high = zip(x, *aside, y, strict=True)
    pivot = f"pivot = {[0.0] * len(low)}"
    low, high = map(list, (low, high))
    return BOX.format(**locals())


def beam(folder, dim, share, turn):
    """A load at mid-span that bends a beam on two supports by this share of its strength."""
    width = None if dim == 2 else HEIGHT
    modulus = HEIGHT**2 / 6 * (width or 1.0)
    weight = share * STRENGTH * modulus * 4 / SPAN
    density = weight / 9.8 / (0.1**2 * (width or 1.0))
    angle = np.radians(turn)
    gravity = [9.8 * np.sin(angle), *[0.0] * (dim - 2), -9.8 * np.cos(angle)]
    text = TEXT.format(dim=dim, gravity=[float(g) for g in gravity], density=density)
    end = SPAN / 2
    text += box("left", "basalt", (-end - 0.03, -end), (-0.05, 0), width, turn, "fixed = true")
    text += box("right", "basalt", (end, end + 0.03), (-0.05, 0), width, turn, "fixed = true")
    text += box("beam", "chalk", (-end - 0.03, end + 0.03), (0, HEIGHT), width, turn, BREAKABLE)
    text += box("load", "heavy", (-0.05, 0.05), (HEIGHT, HEIGHT + 0.1), width, turn)
    path = folder / "beam.toml"
    path.write_text(text)
    return build_simulation(load_scenario(path))[0]


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
