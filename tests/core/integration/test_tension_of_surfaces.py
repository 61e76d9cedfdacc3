"""Water on a free surface is not stretched, Eq. (144), or it is under tension where it meets."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

RHO0 = 1000.0
# A column that runs against a wall, splashes and falls back; as it is, and the other way round.
COLUMN = ("scheme=resolved", "speed_max=4", "tank_height=2", "time_max=2")
MIRRORED = ("body.water.min=[1.2, 0]", "body.water.max=[1.5, 0.6]")


def least_density_on_surface(settings: tuple[str, ...]) -> float:
    """Over rho0, of water without pressure while it splashes."""
    scenario = load_scenario("dambreak", [*COLUMN, *settings])
    simulation, _ = build_simulation(scenario)
    least = np.inf
    for time in np.arange(0.7, 1.45, 0.05):
        simulation.advance(limit=time, pause=np.inf, max_steps=10**6)
        state = simulation.state()
        free = state["pressure"] == 0.0
        least = min(least, np.min(state["density"][free], initial=np.inf))
    return float(least) / RHO0


@pytest.mark.parametrize(
    "settings",
    [("dp=0.03",), ("dp=0.03", *MIRRORED), ("dim=3", "dp=0.05")],
    ids=["2-D", "mirrored", "3-D"],
)
def test_surfaces_keep_no_tension(settings):
    assert least_density_on_surface(settings) > 0.99  # 0.978 where what is stretched stays so
