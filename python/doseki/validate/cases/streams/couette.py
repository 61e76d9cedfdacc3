"""Oil between two cylinders of which one turns: speeds, and the torque on both."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...estimators import moments, rms
from ...running import Running, moving

SPEEDS = "L2(u)"
TORQUES = {"disc": "torque on the disc", "ring": "torque on the ring"}


def turning(particles: float, *overrides: str) -> Outcome:
    """The steady profile of u around the axis, and what turns each cylinder."""
    run = Running("couette", f"particles={particles:g}", *overrides)
    inner, outer, omega, nu = (
        run.constant(name) for name in ("inner", "outer", "omega", "viscosity_m2")
    )
    of_disc = 2 - run.constant("turning")
    state = moving(run.advance(run.scenario.time_max))
    r = np.linalg.norm(state["position"], axis=1)
    u = moments(state["position"], state["velocity"]) / r
    B = omega * inner**2 * outer**2 / (outer**2 - inner**2) * (2 * of_disc - 1)
    A = omega * of_disc - B / inner**2
    torque = 4 * np.pi * 1000 * nu * B
    values = {SPEEDS: Value(rms(u - A * r - B / r) / rms(A * r + B / r))}
    for body, sign in (("disc", -1), ("ring", 1)):
        values[TORQUES[body]] = Value(_torque(run, body), sign * torque)
    at = np.linspace(inner, outer, 101)
    return Outcome(values, [Curve("", r, u, points=True)], [Curve("exact", at, A * at + B / at)])


def _torque(run: Running, body: str) -> float:
    walls = run.of_body(run.state(), body)
    return float((moments(walls["position"], walls["force"]) + walls["moment"]).sum())


def _case(name: str, which: str, turns: int) -> Case:
    return Case(
        name=f"couette-{name}",
        title=f"Oil between a disc and a ring, {which} turns",
        across="gap/dp",
        resolutions=(10, 20, 40),
        run=lambda n: turning(n, f"turning={turns}"),
        criteria=(
            Criterion(SPEEDS, (at_most(0.01),), "the shear falls with the square of the radius"),
            *(
                Criterion(
                    torque,
                    (within(0.06), within(0.04), within(0.02)),
                    "first order in the spacing over the radius of the disc: 5 % at 10",
                    unit="N",
                )
                for torque in TORQUES.values()
            ),
        ),
        axes=("radius (m)", "u (m/s)"),
        controls=(
            Control(
                "the divergence of mu grad v in place of that of the stress",
                TORQUES["disc" if turns == 1 else "ring"],
                lambda n: turning(n, f"turning={turns}", "viscosity=morris"),
            ),
        ),
    )


CASES = (_case("disc", "the disc", 1), _case("ring", "the ring", 2))
