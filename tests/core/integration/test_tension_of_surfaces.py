"""Water that was stretched on a free surface has no tension where it meets again, Eq. (144)."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

# A column that runs against a wall, splashes and falls back; as it is, and the other way round.
COLUMN = ("scheme=resolved", "speed_max=4", "tank_height=2", "time_max=2")
MIRRORED = ("body.water.min=[1.2, 0]", "body.water.max=[1.5, 0.6]")
SPLASH = (0.7, 1.45)  # s
# A splash is chaotic: runs whose steps differ by 0.2 % have 7 to 24 kPa behind a drop in 2-D, and
# 32 to 38 kPa where what has parted keeps its tension.
RUNS = ("cflnumber=0.44", "cflnumber=0.439", "cflnumber=0.438")


def splash(settings: tuple[str, ...]) -> tuple[float, float]:
    """What one step makes of energy at most, over that of the fall; the largest tension, Pa."""
    simulation, _ = build_simulation(load_scenario("dambreak", [*COLUMN, *settings]))
    simulation.advance(limit=SPLASH[0], pause=np.inf, max_steps=10**6)
    left, least = [], 0.0
    while simulation.time < SPLASH[1]:
        simulation.advance(limit=SPLASH[1], pause=np.inf, max_steps=1)
        totals = simulation.totals()
        held = totals["kinetic_energy"] + totals["bulk_energy"] + totals["av_dissipation"]
        left.append(held - totals["gravity_work"] - totals["scheme_work"])
        state = simulation.state()
        least = min(least, state["pressure"][state["motion"] == 0].min())
    return float(np.abs(np.diff(left)).max() / totals["gravity_work"]), -least


@pytest.mark.parametrize(
    "settings",
    [("dp=0.03",), ("dp=0.03", *MIRRORED), ("dim=3", "dp=0.05")],
    ids=["2-D", "mirrored", "3-D"],
)
def test_spray_brings_no_tension(settings):
    made, tension = np.median([splash((*settings, run)) for run in RUNS], axis=0)
    assert made < 3e-4  # 8e-4 to 1.4e-3 where what has parted keeps its tension
    assert tension < 25e3
