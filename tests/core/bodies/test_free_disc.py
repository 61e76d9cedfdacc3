"""A disc that goes through water at rest, without gravity: nothing drives it."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows

WATER = """\
dim = 2
scheme = "resolved"
speed_max = 0.3
dp = 0.001
time_max = 1
time_out = 1
gravity = [0, 0]
periodic = ["x", "y"]
domain_min = [-0.025, -0.025]
domain_max = [0.025, 0.025]

[material.wood]
based_on = "basalt"
rho0 = 1000

[body.water]
shape = "box"
material = "water"
min = [-0.025, -0.025]
max = [0.025, 0.025]
pressure = 20

[body.disc]
shape = "disc"
material = "wood"
centre = [0, 0]
radius = 0.005
velocity = {velocity}
"""
SPEED = 0.1  # m/s


def energies(folder, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Kinetic and compressive energy, and what has been dissipated, J/m, after 0.05 to 0.2 s."""
    velocity = SPEED * np.array([np.cos(angle), np.sin(angle)])
    simulation = Flows(folder)(WATER.format(velocity=velocity.tolist()))
    held, taken = [], []
    for time in (0.05, 0.1, 0.15, 0.2):
        simulation.advance(limit=time, pause=time, max_steps=10**9)
        totals = simulation.totals()
        held.append(totals["kinetic_energy"] + totals["bulk_energy"])
        taken.append(totals["av_dissipation"])
    return np.array(held), np.array(taken)


@pytest.mark.minutes
def test_water_takes_energy_from_a_disc(tmp_path):
    """As much in a turned direction; dissipation along pairs of fluid and wall gave it some."""
    along, turned = (energies(tmp_path, angle) for angle in (0.0, np.pi / 6))
    for held, taken in (along, turned):
        assert (np.diff(held) < 0).all()
        assert (np.diff(taken) > 0).all()
    np.testing.assert_allclose(along[0], turned[0], rtol=0.03)
