"""Taylor-Green vortices at Re 100 and 1000, from a lattice and from a disturbed one."""

from __future__ import annotations

import math

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Run, Value, within
from ...estimators import kinetic_energy
from ...running import Running

SAMPLES = 20
SPEED, ENERGY = "greatest speed, t = 2", "kinetic energy, t = 2"
JITTER = 0.2  # dp, of the disturbed start


def vortices(reynolds: float, jitter: float, simulated: float | None = None) -> Run:
    """The run at a Reynolds number; `simulated` is another one for the liquid of a control."""

    def run_vortices(particles: float) -> Outcome:
        run = Running(
            "taylor-green", f"particles={particles:g}", f"jitter={jitter}",
            f"reynolds={simulated or reynolds}",
        )  # fmt: skip
        times = np.linspace(0, run.scenario.time_max, SAMPLES + 1)
        speed, energy = [], []
        for state in run.sampled(times):
            speed.append(np.sqrt((state["velocity"] ** 2).sum(axis=1).max()))
            energy.append(kinetic_energy(state))
        decay = np.exp(-8 * math.pi**2 * times / reynolds)
        return Outcome(
            {
                SPEED: Value(float(speed[-1]), float(decay[-1])),
                ENERGY: Value(energy[-1] / 250, float(decay[-1] ** 2)),  # rho U2 L2/4 at the start
            },
            [Curve("", times, np.array(speed))],
            [Curve("exact", times, decay)],
        )

    return run_vortices


def case(reynolds: int, jitter: float, controls: tuple[Control, ...] = ()) -> Case:
    """One start at one Reynolds number."""
    start = "disturbed" if jitter else "lattice"
    return Case(
        name=f"taylor-green-{reynolds}-{start}",
        title=f"Taylor-Green vortices, Re = {reynolds}, {start} start",
        across="L/dp",
        resolutions=(50, 100, 200),
        run=vortices(reynolds, jitter),
        criteria=(
            Criterion(
                SPEED,
                (within(0.03), within(0.015), within(0.008)),
                "first order from 3 % at 50 x 50; published weakly compressible schemes lose from "
                "2 to 98 % of it, some of them more on finer lattices",
                order=0.9,
            ),
            Criterion(
                ENERGY, (within(0.06), within(0.03), within(0.016)), "twice as much, being squared"
            ),
        ),
        axes=("time (s)", "greatest speed (m/s)"),
        controls=controls,
    )


MORE_VISCOUS = Control("a liquid of Re = 90", SPEED, vortices(100, 0.0, simulated=90))

CASES = (
    case(100, 0.0, (MORE_VISCOUS,)),
    case(100, JITTER),
    case(1000, 0.0),
    case(1000, JITTER),
)
