"""Options that save time: what they may change, and what not."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, load_core

BODIES = ["particles_per_grain=793", "distance=0.0105", "time_max=1e-3"]


@pytest.fixture(autouse=True)
def one_thread():
    """Leaves the number of threads as it was."""
    core = load_core()
    threads = core.threads()
    core.set_threads(1)
    yield
    core.set_threads(threads)


def started(scenario, *settings):
    """A simulation of a shipped scenario, not yet stepped."""
    return build_simulation(load_scenario(scenario, list(settings)))[0]


def stepped(scenario, *settings, steps=400):
    """The same, some steps on."""
    simulation = started(scenario, *settings)
    simulation.advance(limit=1.0, pause=1.0, max_steps=steps)
    return simulation


def test_chosen_skin_changes_only_rounding():
    plain, chosen = stepped("collision", *BODIES), stepped("collision", *BODIES, "skin=auto")
    assert chosen.skin != plain.skin
    for field in ("position", "velocity", "density"):
        np.testing.assert_allclose(
            chosen.state()[field], plain.state()[field], rtol=1e-9, atol=1e-9
        )


def test_chosen_skin_does_not_depend_on_threads_or_time():
    states = []
    for threads in (1, 1, 2):
        load_core().set_threads(threads)
        simulation = stepped("collision", *BODIES, "skin=auto")
        states.append(
            (simulation.rebuilds, simulation.skin, simulation.state()["velocity"].tobytes())
        )
    assert states[0] == states[1] == states[2]


def test_chosen_skin_grows_with_speed():
    slow, fast = (
        stepped("collision", *BODIES, "skin=auto", f"speed={v}", "xi=0.05") for v in (1, 9)
    )
    assert 0 < slow.skin < fast.skin


def test_fixed_particles_need_not_limit_the_timestep():
    coarse = ("dambreak", "dp=0.03")
    plain, freed = (started(*coarse, f"fixed_limits_dt={flag}") for flag in ("true", "false"))
    water, aluminium = 1400, 5277  # m/s
    ratio = freed.rates()["timestep"] / plain.rates()["timestep"]
    assert ratio == pytest.approx((water + aluminium) / (2 * water), rel=1e-2)
    for name in ("acceleration", "density_rate"):
        np.testing.assert_array_equal(freed.rates()[name], plain.rates()[name])


def test_without_fixed_particles_the_option_changes_nothing():
    plain, freed = (
        stepped("collision", *BODIES, f"fixed_limits_dt={flag}") for flag in ("true", "false")
    )
    assert plain.time == freed.time
