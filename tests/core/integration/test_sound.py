"""Sound that is damped: how fast, where its energy goes, and what would grow without it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from doseki.validate.cases.free_surfaces.hydrostatic import at_rest

LENGTH, DP = 0.2, 0.005
SOUND = f"""\
dim = 2
scheme = "resolved"
speed_max = 1
dp = {DP}
time_max = 1
time_out = 1
gravity = [0, 0]
periodic = ["x", "y"]
domain_min = [0, 0]
domain_max = [{LENGTH}, {LENGTH}]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [{LENGTH}, {LENGTH}]
"""
C = 10.0  # m/s
DAMPED = 0.4


def after_a_period(flows: Any, waves: tuple[int, int], damping: float) -> tuple[float, Any]:
    """What is left of the amplitude of a standing wave, and the simulation."""
    k = 2 * np.pi / LENGTH * np.array(waves)
    along, period = k / np.linalg.norm(k), 2 * np.pi / (C * np.linalg.norm(k))
    velocity = [f"= {1e-3 * a}*sin({k[0]}*x + {k[1]}*y)" for a in along]
    simulation = flows(SOUND, f"body.water.velocity={velocity}", f"acoustic_damping={damping}")

    def amplitude() -> float:
        state = simulation.state()
        return 2 * np.mean((state["velocity"] @ along) * np.sin(state["position"] @ k))

    start = amplitude()
    simulation.advance(limit=period, pause=period, max_steps=10**6)
    return amplitude() / start, simulation


@pytest.mark.parametrize("waves", [(1, 0), (0, 1), (1, 1)], ids=["along x", "along y", "askew"])
def test_sound_is_damped_at_the_rate_of_its_viscosity(core, flows, waves):
    """exp(-alpha c h k^2 t/2), Eq. (136), beside what the Riemann dissipation takes."""
    (damped, _), (free, _) = (after_a_period(flows, waves, alpha) for alpha in (DAMPED, 0.0))
    k = 2 * np.pi / LENGTH * np.linalg.norm(waves)
    assert free > 0.98, "the control: without the damper a wave stays"
    assert np.log(free / damped) == pytest.approx(np.pi * DAMPED * 1.39 * DP * k, rel=0.05)


def test_the_energy_of_damped_sound_is_dissipated(core, flows):
    """Kinetic energy and that of compression go into the account, all of it."""
    _, simulation = after_a_period(flows, (1, 0), DAMPED)
    end = simulation.totals()
    start = 0.25 * 1e-6 * end["mass"]  # kinetic, of an amplitude of 1e-3 m/s
    left = end["kinetic_energy"] + end["bulk_energy"]
    assert left < 0.7 * start
    assert left + end["av_dissipation"] == pytest.approx(start, rel=0.02)


def test_sound_along_a_curved_wall_does_not_grow():
    """Water at rest around a disc. Without the damper its pressure is wrong by more."""
    damped, free = (
        at_rest("hydrostatic-disc")(25, f"acoustic_damping={alpha}").values for alpha in (0.05, 0)
    )
    swing = "swing of p / rho g H"
    assert damped[swing].number < 0.01
    assert free[swing].number > 0.02
