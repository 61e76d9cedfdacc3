"""Two liquids of different viscosity between plates, against two parabolas."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...estimators import rms
from ...running import Running, moving

PULL, HALF, THICK = 0.4, 0.5, 0.5  # m/s2, m, m2/s: those of layers.toml
PROFILE, FASTEST = "L2(u)", "largest speed"


def exact_speed(y: np.ndarray, ratio: float = 10.0) -> np.ndarray:
    """u(y) between plates at 0 and 1 m with one stress and one speed where the liquids meet."""
    thin = THICK / ratio
    rise = PULL / 2 * HALF**2 * (1 / THICK - 1 / thin)
    below, above = np.linalg.solve([[HALF, -HALF], [THICK, thin]], [rise, 2 * PULL * HALF])
    z = 2 * HALF - y
    lower = below * y - PULL / 2 / THICK * y**2
    upper = above * z - PULL / 2 / thin * z**2
    return np.asarray(np.where(y < HALF, lower, upper))


def flow(particles: float, *overrides: str) -> Outcome:
    """The profile at the end, with its error relative to its own size."""
    run = Running("layers", f"particles={particles:g}", *overrides)
    state = moving(run.advance(run.scenario.time_max))
    y, u = state["position"][:, 1], state["velocity"][:, 0]
    exact, line = exact_speed(y), np.linspace(0, 1, 201)
    values = {
        PROFILE: Value(rms(u - exact) / rms(exact)),
        FASTEST: Value(float(u.max()), float(exact_speed(line).max())),
    }
    reference = [Curve("exact", exact_speed(line), line)]
    return Outcome(values, [Curve("", u, y, points=True)], reference)


CASES = (
    Case(
        name="layers",
        title="Two liquids between two plates",
        across="d/dp",
        resolutions=(20, 40, 80),
        run=flow,
        criteria=(
            Criterion(
                PROFILE,
                (at_most(0.02), at_most(0.008), at_most(0.004)),
                "0.4 % at 80 particles across the gap; with the mean viscosity of both in pairs"
                " 6.7 % at 20",
            ),
            Criterion(FASTEST, (within(0.01), within(0.005), within(0.004)), "0.4 % at 80"),
        ),
        axes=("u (m/s)", "y (m)"),
        controls=(Control("one viscosity", PROFILE, lambda n: flow(n, "ratio=1")),),
    ),
)
