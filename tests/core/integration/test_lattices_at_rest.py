"""Square and cubic lattices of water under pressure hold, without walls or gravity."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.running import Running

PARTICLES = {2: 20, 3: 10}  # along a side
FORMER_ETA = 1.3  # smoothing length over spacing, at which rows slide against each other


def speeds(run: Running, units: float) -> float:
    """Their root mean square over sqrt(p/rho) at a time, in units of dp sqrt(rho/p)."""
    wave = np.sqrt(run.constant("pressure") / 1000)
    velocity = run.advance(units * run.scenario.dp / wave)["velocity"]
    return float(np.sqrt(np.mean((velocity**2).sum(axis=1))) / wave)


@pytest.mark.parametrize("kernel", ["as it is", "control"])
def test_what_is_off_its_lattice_comes_to_rest(dim, kernel):
    former = [f"eta={FORMER_ETA}"] if kernel == "control" else []
    run = Running("still-water", f"dim={dim}", f"particles={PARTICLES[dim]}", *former)
    early, late = speeds(run, 10), speeds(run, 40)
    if former:
        assert late > early
    else:
        assert late < 0.5 * early
