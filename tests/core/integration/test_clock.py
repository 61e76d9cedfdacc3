"""When `advance` stops, and that stopping changes nothing."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import FOREVER, colliding_grains, run_to


@pytest.fixture
def collision(simulate):
    """Makes the same collision again and again."""
    grains = colliding_grains(2)
    return lambda: simulate(grains.position, grains.velocity, alpha=1.0)


def test_limit_is_met_exactly(collision):
    simulation = collision()
    for limit in (1e-4, 1e-3 / 3, 1.2345e-3):
        run_to(simulation, limit)
        assert simulation.time == limit


def test_a_limit_in_the_past_does_nothing(collision):
    simulation = run_to(collision(), 1e-4)
    steps = simulation.steps
    simulation.advance(limit=5e-5, pause=1.0, max_steps=FOREVER)
    assert (simulation.time, simulation.steps) == (1e-4, steps)


def test_pause_ends_with_the_step_that_reaches_it(collision):
    """The step is not shortened: the pause lies within the last step."""
    simulation = collision()
    simulation.advance(limit=1.0, pause=3.3e-4, max_steps=FOREVER)
    assert 0 <= simulation.time - 3.3e-4 < simulation.timestep
    assert simulation.time != 3.3e-4


def test_limit_goes_before_pause(collision):
    simulation = collision()
    simulation.advance(limit=3.3e-4, pause=1.0, max_steps=FOREVER)
    assert simulation.time == 3.3e-4


def test_number_of_steps_is_kept(collision):
    simulation = collision()
    simulation.advance(limit=1.0, pause=1.0, max_steps=7)
    assert simulation.steps == 7
    assert simulation.updates == 7 * len(simulation)


def test_pauses_and_bursts_change_nothing(collision):
    """Bit for bit the run that was never interrupted."""
    straight, interrupted = run_to(collision(), 1e-3), collision()
    while interrupted.time < 5e-4:
        interrupted.advance(limit=1e-3, pause=interrupted.time + 1e-4, max_steps=3)
    run_to(interrupted, 1e-3)
    assert interrupted.steps == straight.steps
    expected, state = straight.state(), interrupted.state()
    for name, values in expected.items():
        np.testing.assert_array_equal(state[name], values, err_msg=name)


def test_looking_changes_nothing(collision):
    """state(), rates() and totals() only read."""
    watched, unwatched = collision(), collision()
    for _ in range(20):
        for simulation in (watched, unwatched):
            simulation.advance(limit=1.0, pause=1.0, max_steps=1)
        watched.state(), watched.rates(), watched.totals()
    np.testing.assert_array_equal(watched.state()["velocity"], unwatched.state()["velocity"])
