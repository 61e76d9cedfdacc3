"""A step that something cuts short costs no energy in the ledger."""

from __future__ import annotations

import pytest

from ..flows import CHANNEL, advance

SPLASH = """\
dim = 2
scheme = "resolved"
speed_max = 3
dp = 0.02
time_max = 1
time_out = 1
gravity = [0, -9.8]

[body.water]
shape = "box"
material = "water"
jitter = 0.2
min = [0, 0.02]
max = [0.2, 0.3]
velocity = [1.0, -1.5]

[body.tank]
shape = "tank"
material = "basalt"
min = [-0.2, 0]
max = [0.5, 0.6]
"""


def made_by_corrections(simulation):
    """J/m."""
    return simulation.totals()["scheme_work"]


@pytest.mark.parametrize("time", [0.05, 0.15])
def test_corrections_make_no_more_in_a_step_that_is_cut_short(flows, time):
    """Surfaces part and meet at once, and what is below its least density is brought to it."""
    run = flows(SPLASH)
    run.advance(limit=time, pause=time, max_steps=10**6)
    kinetic = run.totals()["kinetic_energy"]
    for _ in range(10):
        before, end = made_by_corrections(run), run.time + 1e-9
        run.advance(limit=end, pause=end, max_steps=1)
        advance(run, 1)
        assert abs(made_by_corrections(run) - before) < 1e-3 * kinetic


def test_an_output_beside_a_layer_that_is_due_takes_no_step_of_its_own(flows):
    """Steps end a rounding before a layer is due; what is asked for then is the same time."""
    run, count = flows(CHANNEL), 0
    while len(run) <= count or not count:
        count = len(run)
        advance(run, 1)
    due = run.time * (1 + 1e-10)
    run = flows(CHANNEL)
    run.advance(limit=due, pause=due, max_steps=10**6)
    assert run.time == due
    steps = run.steps
    other = flows(CHANNEL)
    other.advance(limit=due, pause=0.9999 * due, max_steps=10**6)
    assert (other.time, other.steps) == (due, steps)
