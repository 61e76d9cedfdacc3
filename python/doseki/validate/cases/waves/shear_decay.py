"""A shear wave: what viscosity the scheme adds, and whether it has that of the liquid."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, small, within
from ...estimators import wave_amplitude
from ...running import Running

SAMPLES = 40
SETTLED = 0.25  # share of the run left out: the particles leave their lattice
NUMERICAL, DECAY = "nu_num / (c h)", "decay with nu = 1e-3"


def viscosity(particles: float, nu: float) -> tuple[float, float, Curve]:
    """(fitted viscosity, c h, the amplitude over time) of a liquid of viscosity `nu`."""
    run = Running("shear-decay", f"particles={particles:g}", f"material.water.nu={nu}")
    k = 2 * np.pi / run.constant("length")
    times = np.linspace(0, run.scenario.time_max, SAMPLES + 1)
    wave = np.array([wave_amplitude(state, 0, 1, k) for state in run.sampled(times)])
    late = (times >= SETTLED * times[-1]) & (wave > 0)
    fitted = -np.polyfit(times[late], np.log(wave[late]), 1)[0] / k**2 if late.sum() > 2 else np.nan
    state = run.state()
    scale = float(state["sound_speed"].max() * state["smoothing_length"].max())
    return float(fitted), scale, Curve(f"nu = {nu:g},", times, wave / wave[0])


def decay(particles: float, nu: float = 1e-3) -> Outcome:
    """Without viscosity and with `nu`, judged as if that were 1e-3."""
    numerical, scale, inviscid = viscosity(particles, 0.0)
    fitted, _, viscous = viscosity(particles, nu)
    k2, t = (2 * np.pi) ** 2, viscous.x
    lost, expected = np.exp(-fitted * k2 * t[-1]), np.exp(-1e-3 * k2 * t[-1])
    return Outcome(
        {NUMERICAL: Value(numerical / scale), DECAY: Value(float(lost), float(expected))},
        [inviscid, viscous],
        [Curve("exact, nu = 0.001", t, np.exp(-1e-3 * k2 * t))],
    )


CASES = (
    Case(
        name="shear-decay",
        title="Decay of a shear wave: numerical viscosity",
        across="L/dp",
        resolutions=(20, 40, 80),
        run=decay,
        criteria=(
            Criterion(
                NUMERICAL,
                (small(1e-3),),
                "the printed scheme has 0.054, a hundred times too much for a film of water",
            ),
            Criterion(
                DECAY,
                (within(0.06), within(0.03), within(0.015)),
                "what 1e-3 c h takes off beside exp(-nu k2 t) in the same time",
            ),
        ),
        axes=("time (s)", "amplitude / first amplitude"),
        controls=(Control("a liquid five times as viscous", DECAY, lambda n: decay(n, nu=5e-3)),),
    ),
)
