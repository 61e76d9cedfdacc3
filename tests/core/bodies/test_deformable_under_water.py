"""Bodies that deform have the uplift of the water below them, as rigid ones have."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.solver.build import empty_simulation
from doseki.validate.running import CASES, Running

BLOCK = CASES / "grains/block-under-water.toml"
SIDE = 0.1  # m
ELASTIC = (
    "body.block.kinematics=elastic", "body.block.damping=0.3",
    "material.stone.young_modulus=1e8", "material.stone.poisson_ratio=0.25",
)  # fmt: skip


def lift(run: Running, time: float) -> float:
    """Of the water on a block at a time, over the weight of the water that it displaces."""
    state, gravity = run.advance(time), np.asarray(run.scenario.gravity)
    force = state["force"][state["body"] == run.body_names.index("block")].sum(0)
    return float(-force @ gravity / (1000 * SIDE**run.scenario.dim * (gravity @ gravity)))


def late_lift(run: Running) -> float:
    return float(np.mean([lift(run, time) for time in np.linspace(0.15, 0.3, 7)]))


@pytest.mark.parametrize("given", [("across=16",), ("across=16", "tilt=20"), ("dim=3", "across=6")])
def test_a_block_has_its_uplift_from_the_first_step_on(given):
    run = Running(str(BLOCK), *ELASTIC, *given)
    assert lift(run, 0.0) == pytest.approx(1, abs=0.06)
    assert late_lift(run) == pytest.approx(1, abs=0.04)


def test_the_film_of_a_soft_one_turns_with_its_face():
    """It sags by its own weight, and swings."""
    run = Running(str(BLOCK), *ELASTIC, "across=16", "material.stone.young_modulus=1e6")
    assert late_lift(run) == pytest.approx(1, abs=0.1)


def test_without_films_it_is_pressed_down():
    """The control."""
    assert late_lift(Running(str(BLOCK), *ELASTIC, "across=16", "uplift=false")) < 0.5


def test_a_restored_run_goes_on_with_the_same_bits():
    run = Running(str(BLOCK), *ELASTIC, "across=8")
    run.advance(0.02)
    other = empty_simulation(run.scenario, run.body_names)
    assert other.restore(run.simulation.checkpoint())
    ends = []
    for simulation in (run.simulation, other):
        simulation.advance(limit=0.03, pause=0.03, max_steps=10**6)
        ends.append(simulation.state())
    for key, values in ends[0].items():
        np.testing.assert_array_equal(values, ends[1][key], err_msg=key)
