"""Flows with all there is in a step: the same bits on any number of threads."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.bench.flows import FLOWS
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

# Small particles, so that every loop has enough work to be shared.
SETTINGS = ["diameter=0.004", "flume_length=3.5", "load_start=1.5", "strength=true"]


@pytest.mark.minutes
@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_threads_change_no_bit_of_the_flume(core, precision):
    scenario = load_scenario("flume", [*SETTINGS, f"precision={precision}"])
    states = []
    for threads in (1, 2, 4):
        core.set_threads(threads)
        simulation, _ = build_simulation(scenario)
        simulation.advance(limit=1.0, pause=1.0, max_steps=600)
        assert simulation.rebuilds > 1
        assert simulation.totals()["mass_entered"] > 0
        states.append(simulation.state() | {"totals": simulation.totals(), "time": simulation.time})
    assert len(states[0]["id"]) > 8192
    for state in states[1:]:
        for name, values in states[0].items():
            np.testing.assert_equal(state[name], values, err_msg=name)


def test_threads_change_no_bit_of_grains_that_touch(core):
    scenario = load_scenario(FLOWS["tumbler"].scenario)
    states = []
    for threads in (1, 2, 4):
        core.set_threads(threads)
        simulation, _ = build_simulation(scenario)
        simulation.advance(limit=1.0, pause=1.0, max_steps=300)
        states.append(simulation.checkpoint())
    assert len(states[0]["contact_springs"]) > 64, "enough to be shared"
    assert states[0]["contact_springs"].any(), "some touch"
    for state in states[1:]:
        for name, values in states[0].items():
            np.testing.assert_array_equal(state[name], values, err_msg=name)
