"""Square and cubic lattices of water under pressure hold, without walls or gravity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

DP, PRESSURE = 0.01, 500.0  # m; Pa, half a hundredth of rho c^2
TIME_UNIT = DP / np.sqrt(PRESSURE / 1000)
SIDES = {2: 0.2, 3: 0.1}
FORMER_ETA = 1.3  # smoothing length over spacing, at which rows slide against each other

WATER = f"""\
scheme = "resolved"
speed_max = 1
dp = {DP}
time_max = 10
time_out = 10

[body.water]
shape = "box"
material = "water"
pressure = {PRESSURE}
jitter = 0.01
"""


def periodic_box(dim: int, side: float) -> list[str]:
    """Overrides that put the water into a box without walls."""
    return [
        f"dim={dim}", f"gravity={[0] * dim}", f"periodic={list('xyz'[:dim])}",
        f"domain_min={[0] * dim}", f"domain_max={[side] * dim}",
        f"body.water.min={[0] * dim}", f"body.water.max={[side] * dim}",
    ]  # fmt: skip


def speeds(simulation: Any, units: float) -> float:
    """Their root mean square over sqrt(p/rho) at a time."""
    time = units * TIME_UNIT
    simulation.advance(limit=time, pause=time, max_steps=10**6)
    velocity = simulation.state()["velocity"]
    return float(np.sqrt(np.mean((velocity**2).sum(axis=1)) / (PRESSURE / 1000)))


@pytest.mark.parametrize("kernel", ["as it is", "control"])
def test_what_is_off_its_lattice_comes_to_rest(core, flows, dim, kernel):
    former = [f"eta={FORMER_ETA}"] if kernel == "control" else []
    simulation = flows(WATER, *periodic_box(dim, SIDES[dim]), *former)
    early, late = speeds(simulation, 10), speeds(simulation, 40)
    if former:
        assert late > early
    else:
        assert late < 0.5 * early
