"""The terms that a failure report names add up to what the core computed."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.core import build_simulation
from doseki.forces import particle_terms
from doseki.scenario import load_scenario


@pytest.mark.parametrize("name", ["film", "hang"])
def test_terms_add_up_to_the_acceleration(name):
    scenario = load_scenario(name, ["skin=0"])
    simulation, _ = build_simulation(scenario)
    simulation.advance(limit=1.0, pause=1.0, max_steps=300)
    state, rates = simulation.state(), simulation.rates()
    state["balsara"] = rates["balsara"]
    scale = np.linalg.norm(rates["acceleration"], axis=1).max()
    free = np.flatnonzero(state["motion"] == 0)
    for k in free[:: max(1, len(free) // 7)]:
        total = sum(particle_terms(scenario, state, k).acceleration.values())
        # The core's sums are of the state predicted within the step.
        np.testing.assert_allclose(total, rates["acceleration"][k], atol=0.02 * scale)
