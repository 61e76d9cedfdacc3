"""The scheme as printed: a shear wave decays as if the artificial viscosity were water's own."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, within
from ...estimators import wave_amplitude
from ...running import Running

SAMPLES = 60
# Sum of Eq. (13) over an isotropic neighbourhood of which half approaches: 3/32 <r>/h in 2-D,
# with <r> = 0.6531 h the mean of r under the kernel.
EXPECTED = 3 / 32 * 0.6531
QUANTITY = "nu / (alpha c h)"


def decay(particles: float, *overrides: str) -> Outcome:
    """Of the amplitude from 0.9 to 0.5; before that the lattice is still in order."""
    run = Running("shear-wave", f"particles={particles:g}", *overrides)
    length, h = run.constant("length"), run.scenario.eta * run.scenario.dp
    k, c = 2 * np.pi / length, run.scenario.materials["water"].scaled(run.scenario.xi).speedsound
    times = np.linspace(0, 1.0 / (EXPECTED * c * h * k**2), SAMPLES + 1)
    amplitude = np.array([wave_amplitude(state, 0, 1, k) for state in run.sampled(times)])
    amplitude /= amplitude[0]
    part = (amplitude < 0.9) & (amplitude > 0.5)
    if part.sum() < 3:  # it hardly decays
        part = np.ones(len(times), bool)
    nu = -np.polyfit(times[part], np.log(amplitude[part]), 1)[0] / k**2
    scaled = EXPECTED * c * h * k**2 * times
    return Outcome(
        {QUANTITY: Value(nu / (c * h), EXPECTED)},
        [Curve("", scaled, amplitude)],
        [Curve("exact", scaled, np.exp(-scaled))],
    )


CASES = (
    Case(
        name="artificial-viscosity",
        title="Viscosity that the artificial viscosity of the printed scheme amounts to",
        across="L/dp",
        resolutions=(20, 30, 40),
        run=decay,
        criteria=(
            Criterion(
                QUANTITY,
                (within(0.08),),
                "the sum takes an isotropic neighbourhood of which exactly half approaches; an "
                "independent prototype was 5 % above it",
            ),
        ),
        axes=("time over decay time", "amplitude"),
        controls=(Control("with Balsara's switch", QUANTITY, lambda n: decay(n, "balsara=true")),),
    ),
)
