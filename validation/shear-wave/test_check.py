"""A shear wave decays as if the artificial viscosity were a viscosity of water."""

from __future__ import annotations

import numpy as np
import pytest

from ..cases import Case

SAMPLES = 100
# nu / (alpha c h) of Eq. (13) in shear, summed over an isotropic neighbourhood of which half
# approaches: 3/32 <r>/h in 2-D and 1/15 <r>/h in 3-D, with <r> the mean of r under the kernel.
THEORY = {2: 3 / 32 * 0.6531, 3: 1 / 15 * 0.8203}


def decay(case, time):
    """Times and amplitudes of the wave, the latter relative to the first one."""
    k = wave_number(case)
    times, amplitudes = np.linspace(0, time, SAMPLES + 1), []
    for t in times:
        state = case.advance(t)
        phase = k * state["position"][:, -1]
        amplitudes.append(2 * np.mean(state["velocity"][:, 0] * np.sin(phase)))
    return times, np.array(amplitudes) / amplitudes[0]


def wave_number(case):
    """2 pi over the length of the domain."""
    return 2 * np.pi / case.scenario.constants["length"]


def viscosity(case, times, amplitudes):
    """nu / (alpha c h) from the logarithmic decrement."""
    scenario = case.scenario
    c = scenario.materials["water"].scaled(scenario.xi).speedsound
    rate = -np.polyfit(times, np.log(amplitudes), 1)[0]
    return rate / wave_number(case) ** 2 / (scenario.alpha * c * scenario.eta * scenario.dp)


@pytest.mark.parametrize(
    ("dim", "time", "overrides"),
    [
        (2, 0.06, []),
        pytest.param(3, 0.025, ["particles=24"], marks=pytest.mark.validate),
    ],
    ids=["2d", "3d"],
)
def test_viscosity_without_switch(dim, time, overrides, report):
    """While the amplitude falls from 0.9 to 0.5; before that the lattice is still in order."""
    case = Case("shear-wave", f"dim={dim}", *overrides)
    times, amplitudes = decay(case, time)
    assert amplitudes[-1] < 0.5
    part = (amplitudes < 0.9) & (amplitudes > 0.5)
    found = viscosity(case, times[part], amplitudes[part])
    report("nu / (alpha c h)", found, THEORY[dim])
    assert found == pytest.approx(THEORY[dim], rel=0.08)


def test_viscosity_with_switch(report):
    """Balsara's switch takes nearly all of it away while the lattice is young."""
    case = Case("shear-wave", "balsara=true")
    times, amplitudes = decay(case, 0.03)
    found = viscosity(case, times, amplitudes)
    report("nu / (alpha c h)", found, "below 0.003")
    assert 0 < found < 0.003


def test_shear_wave_without_artificial_viscosity(report):
    """What is left is what water itself has, and what the scheme adds."""
    case = Case("shear-wave", "alpha=0")
    _, amplitudes = decay(case, 0.02)
    lost = 1 - amplitudes[-1]
    report("loss of amplitude in 0.02 s", lost, "below 1e-3")
    assert abs(lost) < 1e-3
