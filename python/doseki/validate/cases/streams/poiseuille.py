"""Flow between plates against the series solution, on the way up and at the end."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most
from ...estimators import rms
from ...running import Running, moving

TERMS = 40
EARLY, LATE = "L2(u), t nu/d2 = 0.1", "L2(u), t nu/d2 = 0.5"
TIMES = {EARLY: 1.0, LATE: 5.0}  # s, with d2/nu = 10 s


def exact_speed(y: np.ndarray, time: float, nu: float = 0.1) -> np.ndarray:
    """u(y, t) for d = 1 m and a force of 8 nu, started from rest."""
    odd = 2 * np.arange(TERMS)[:, None] + 1
    series = 32 / (odd * np.pi) ** 3 * np.sin(odd * np.pi * y)
    return 4 * y * (1 - y) - (series * np.exp(-((odd * np.pi) ** 2) * nu * time)).sum(axis=0)


def flow(particles: float, *overrides: str) -> Outcome:
    """The profile at both times, its error relative to the profile's own size."""
    run = Running("poiseuille", f"particles={particles:g}", *overrides)
    values, curves = {}, []
    for name, time in TIMES.items():
        state = moving(run.advance(time))
        y, u = state["position"][:, 1], state["velocity"][:, 0]
        exact = exact_speed(y, time)
        values[name] = Value(rms(u - exact) / rms(exact))
        curves.append(Curve(f"t = {time:g} s,", u, y, points=True))
    y = np.linspace(0, 1, 101)
    reference = [Curve(f"exact, {t:g} s", exact_speed(y, t), y) for t in TIMES.values()]
    return Outcome(values, curves, reference)


CASES = (
    Case(
        name="poiseuille",
        title="Flow between two plates",
        across="d/dp",
        resolutions=(10, 20, 40),
        run=flow,
        criteria=tuple(
            Criterion(
                name,
                (at_most(0.08), at_most(0.028), at_most(0.01)),
                "1 % at 40 particles across the gap, and order 1.5 from there to the coarser ones",
                order=1.5,
                short="0.2 % of too little viscosity, of the kernel's sums over particles that "
                "shear has arranged, does not fall with the spacing",
            )
            for name in TIMES
        ),
        axes=("u (m/s)", "y (m)"),
        controls=(Control("free-slip walls", LATE, lambda n: flow(n, "wall=free_slip")),),
    ),
)
