"""The least dissipation of the Riemann solver is no viscosity of a slow liquid, Eq. (145)."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.estimators import wave_amplitude
from doseki.validate.running import Running

VISCOSITY = 0.01  # m2/s, of a wave of 1 m and 1 m/s
ALONG_X = 'body.water.velocity=["= sin(2*pi*y/length)", 0]'
ALONG_Y = 'body.water.velocity=[0, "= -sin(2*pi*x/length)"]'


def fitted_viscosity(speed_max: float, velocity: str = ALONG_X, factor: float = 1.0) -> float:
    """Over VISCOSITY, from a shear wave of 12 particles in a liquid of `factor` times that."""
    run = Running(
        "shear-decay", "particles=12", f"material.water.nu={factor * VISCOSITY}",
        f"speed_max={speed_max:g}", velocity,
    )  # fmt: skip
    component = 0 if velocity == ALONG_X else 1
    rate = VISCOSITY * (2 * np.pi) ** 2
    times = np.linspace(0.25, 1, 9) / rate
    waves = [
        abs(wave_amplitude(state, component, 1 - component, 2 * np.pi))
        for state in run.sampled(times)
    ]
    return float(-np.polyfit(times, np.log(waves), 1)[0] / rate)


@pytest.mark.parametrize("velocity", [ALONG_X, ALONG_Y], ids=["along x", "along y, mirrored"])
def test_viscosity_does_not_follow_the_sound_speed(velocity):
    slow, fast = (fitted_viscosity(speed, velocity) for speed in (1, 10))
    assert slow == pytest.approx(1, abs=0.06)
    assert fast == pytest.approx(1, abs=0.06)  # 1.53 with all of the least beta


def test_a_fifth_more_viscosity_shows():
    assert fitted_viscosity(10, factor=1.2) == pytest.approx(1.2, abs=0.06)
