"""Prescribed motions in a scenario file."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation
from doseki.solver.wall_motions import wall_motions

from ..small_scenarios import BLOCK

GATE = """
[body.gate]
shape = "box"
material = "aluminium"
fixed = true
min = [1.5, 0]
max = [1.8, 1]
motion = { velocity = [0, 2], start = 0.01, stop = 0.02, removed_at = 0.03 }
"""


def test_a_motion_reaches_the_core(write):
    scenario = load_scenario(write(tables=BLOCK + GATE))
    (motion,) = wall_motions(scenario, ["block", "gate"])
    assert motion == {
        "body": 1, "velocity": [0.0, 2.0], "angular_velocity": [0.0, 0.0, 0.0],
        "pivot": [0.0, 0.0], "start": 0.01, "stop": 0.02, "removed_at": 0.03,
    }  # fmt: skip
    simulation, _ = build_simulation(scenario)
    before = simulation.state()
    gate = before["body"] == 1
    simulation.advance(limit=0.025, pause=0.025, max_steps=10**6)
    after = simulation.state()
    shift = after["position"][gate] - before["position"][gate]
    np.testing.assert_allclose(shift, np.broadcast_to([0, 0.02], shift.shape), atol=1e-12)
    simulation.advance(limit=0.031, pause=0.031, max_steps=10**6)
    assert len(simulation) == np.sum(~gate)


def test_what_is_not_given_never_happens(write):
    text = GATE.replace("start = 0.01, stop = 0.02, removed_at = 0.03", "start = 0.5")
    (motion,) = wall_motions(load_scenario(write(tables=text)), ["gate"])
    assert (motion["stop"], motion["removed_at"]) == (math.inf, math.inf)


def test_the_effective_scenario_keeps_the_motion(write, tmp_path):
    scenario = load_scenario(write(tables=BLOCK + GATE))
    (tmp_path / "again.toml").write_text(scenario.effective_toml())
    again = load_scenario(str(tmp_path / "again.toml"))
    names = ["block", "gate"]
    assert wall_motions(again, names) == wall_motions(scenario, names)


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("fixed = true", "fixed = false", "only a body with fixed = true"),
        ("fixed = true", "fixed = true\nvelocity = [1, 0]", "exclude each other"),
        ("stop = 0.02", "stop = 0.01", "must be later than start = 0.01 s"),
        ("start = 0.01", "strat = 0.01", "body.gate.motion.strat is not a known key; did you mean"),
        ("velocity = [0, 2]", "velocity = [0, 2, 0]", "a 2-D run needs 2 entries"),
        ("velocity = [0, 2]", "angular_velocity = 1", "angular_velocity needs a pivot"),
        (
            "velocity = [0, 2]",
            "angular_velocity = [0, 1], pivot = [0, 0]",
            "a 2-D run needs a number, rad/s",
        ),
        ("removed_at = 0.03", "removed_at = 0", "removed_at = 0 is out of range"),
        (
            "removed_at = 0.03",
            "removed_at = 0.01",
            "must be later than start = 0.01 s: a body that",
        ),
        (
            "velocity = [0, 2], start = 0.01, stop = 0.02, removed_at = 0.03",
            "start = 1",
            "give velocity, angular_velocity or removed_at",
        ),
    ],
)
def test_wrong_motions(write, error_of, old, new, part):
    assert old in GATE
    message = error_of(write(tables=BLOCK + GATE.replace(old, new)))
    assert part in message
    assert "body.gate" in message


def test_nothing_turns_out_of_a_periodic_axis(write, error_of):
    domain = 'periodic = ["x"]\ndomain_min = [0, -1]\ndomain_max = [2, 2]'
    text = GATE.replace("velocity = [0, 2]", "angular_velocity = 1, pivot = [0, 0]")
    assert "periodic axis x" in error_of(write(domain, BLOCK + text))
