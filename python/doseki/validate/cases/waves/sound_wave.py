"""A standing sound wave swings with the sound speed of the run."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...estimators import crossings, wave_amplitude
from ...running import Running

SAMPLES = 200
SPEED, LOSS = "speed / c", "loss of amplitude a period"


def swing(particles: float, assumed: float = 1.0) -> Outcome:
    """Two periods; `assumed` times the sound speed is what is compared with."""
    run = Running("sound-wave", f"particles={particles:g}")
    c = float(run.state()["sound_speed"].max()) * assumed
    k = 2 * np.pi / run.constant("length")
    times = np.linspace(0, run.scenario.time_max, SAMPLES + 1)
    wave = np.array([wave_amplitude(state, 0, 0, k) for state in run.sampled(times)]) / 1e-4 / c
    zeros = crossings(times, wave)
    nodes = len(zeros) - 1
    speed = np.pi * nodes / (zeros[-1] - zeros[0]) / k if nodes > 0 else float("nan")
    half = SAMPLES // 2
    loss = 1 - np.sqrt(np.mean(wave[half:] ** 2) / np.mean(wave[: half + 1] ** 2))
    return Outcome(
        {SPEED: Value(speed / c, 1.0), LOSS: Value(float(loss))},
        [Curve("", c * k * times, wave)],
        [Curve("exact", c * k * times, np.cos(c * k * times))],
    )


CASES = (
    Case(
        name="sound-wave",
        title="Standing sound wave in water",
        across="lambda/dp",
        resolutions=(20, 40, 80),
        run=swing,
        criteria=(
            Criterion(
                SPEED,
                (within(0.005), within(0.0015), within(0.0015)),
                "0.5 % at 20 particles to a wavelength, 0.15 % at 40; second order in space",
                order=1.8,
                short="the kernel smooths the wave twice: -2.8 % at 20, second order; corrected "
                "gradients of higher order would cure it",
            ),
            Criterion(
                LOSS,
                (at_most(0.2), at_most(0.05), at_most(0.02)),
                "dissipation of the Riemann solution, limited for weak waves",
            ),
        ),
        axes=("phase k c t", "amplitude / first amplitude"),
        controls=(Control("a sound speed 2 % too high", SPEED, lambda n: swing(n, assumed=1.02)),),
    ),
)
