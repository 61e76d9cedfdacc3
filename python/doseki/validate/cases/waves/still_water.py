"""Water under pressure without walls: whether particles stay on their lattice."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...estimators import kinetic_energy
from ...running import Running

SAMPLES = 40
LATE = 0.5  # share of the run after which it has to rest
ENERGY, PRESSURE = "KE / p V", "pressure"


def still(particles: float, *overrides: str) -> Outcome:
    """The kinetic energy over the work of the pressure, and the pressure that is left."""
    run = Running("still-water", f"particles={particles:g}", *overrides)
    pressure, volume = run.constant("pressure"), run.constant("length") ** 2
    times = np.linspace(0, run.scenario.time_max, SAMPLES + 1)[1:]
    energy = np.array([kinetic_energy(state) for state in run.sampled(times)])
    energy /= pressure * volume
    left = float(run.state()["pressure"].mean())
    late = times > LATE * times[-1]
    return Outcome(
        {ENERGY: Value(float(energy[late].mean())), PRESSURE: Value(left, pressure)},
        [Curve("", times, np.log10(energy))],
    )


CASES = (
    Case(
        name="still-water",
        title="Still water under pressure, without walls",
        across="L/dp",
        resolutions=(20, 40, 80),
        run=still,
        criteria=(
            Criterion(
                ENERGY,
                (at_most(1e-7),),
                "0.04 % of sqrt(p/rho); where a lattice gives way it is ten times as fast",
            ),
            Criterion(PRESSURE, (within(0.02),), "neither mass nor volume changes", unit="Pa"),
        ),
        axes=("time (s)", "log10 of the kinetic energy over p V"),
        controls=(
            Control("a kernel of 2.6 spacings", ENERGY, lambda n: still(n, "eta=1.3")),
            Control("a kernel of 2.4 spacings", PRESSURE, lambda n: still(n, "eta=1.2")),
        ),
    ),
)
