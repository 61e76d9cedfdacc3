"""What Voellmy's bed does to a liquid that is not stiff."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.validate.running import Running, moving

MU, ANGLE = 0.4663, math.radians(35)
LIQUID = "material.grains.viscosity_max=75"  # Pa s, 0.05 m2/s; its yield stress is never reached
STIFF = "material.grains.viscosity_max=3e4"


def gain(law, particles=8):
    """Acceleration of a layer 0.2 m thick between 0.8 and 1.1 s, over that of the closed form."""
    settings = (
        f"friction={MU}",
        "angle=35",
        "speed=4",
        "time_max=2",
        f"particles={particles}",
        law,
    )
    run = Running("voellmy-slab", *settings)
    times, speeds = np.linspace(0.8, 1.1, 7), []
    for state in run.sampled(times):
        body = moving(state)
        speeds.append(-np.average(body["velocity"][:, 0], weights=body["mass"]))
    exact = 9.81 * (math.sin(ANGLE) - MU * math.cos(ANGLE))
    return float(np.polyfit(times, speeds, 1)[0]) / exact


@pytest.mark.validate
def test_a_stiff_layer_has_the_friction_of_its_weight():
    assert gain(STIFF) == pytest.approx(1.0, rel=0.02)


@pytest.mark.validate
@pytest.mark.parametrize("particles", [8, 16])
def test_a_liquid_has_the_friction_of_its_weight(particles):
    """Whatever sound runs to and fro in it."""
    assert gain(LIQUID, particles) == pytest.approx(1.0, rel=0.02)
