"""A run that goes wrong says which particle, and stops."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import WATER, run_to


def test_a_broken_density_is_reported(core, simulate, dim):
    """Not a number in, a named particle out."""
    with pytest.raises(core.PhysicsFailure, match=r"particle [01] \(water\)"):
        simulate(
            np.eye(2, dim) * 0.01, 0.0, materials=(WATER,), columns={"density": [1000.0, np.nan]}
        )


def test_a_particle_that_leaves_the_world_is_reported(core, simulate, dim):
    simulation = simulate(np.zeros((1, dim)), 1e9, materials=(WATER,))
    with pytest.raises(core.PhysicsFailure, match=r"t = .* s, step \d+: particle 0 \(water\)"):
        run_to(simulation, 100.0)
