"""What a run of the resolved scheme must not depend on: threads, interruptions, instruction set."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import CHANNEL, FILM, advance, assert_same_bits
from ..instruction_sets import INSTRUCTION_SETS

STEPS = 120
PERIOD = 0.2  # of FILM in 2-D, m
PRECISIONS = ("double", "mixed")


def result(simulation):
    """State, rates and totals as one mapping."""
    return simulation.state() | simulation.rates() | {"totals": simulation.totals()}


def channel(flows, *settings, **options):
    """Water that enters over a rough bed: lists are renewed, particles appear and leave."""
    return flows(CHANNEL, *settings, **options)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(
    ("text", "dp"), [(CHANNEL, 0.004), (FILM.format(dim=3), 0.0075)], ids=["channel", "film in 3-D"]
)
def test_threads_change_no_bit(core, flows, text, dp, precision):
    results = []
    for threads in (1, 2, 4):
        core.set_threads(threads)
        simulation = advance(flows(text, f"dp={dp}", f"precision={precision}"), STEPS // 2)
        assert len(simulation) > 2048  # below, some loops stay on one thread
        results.append(result(simulation))
    for other in results[1:]:
        assert_same_bits(results[0], other)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("steps", [0, 1, STEPS])
def test_a_restored_run_goes_on_with_the_same_bits(core, flows, steps, precision):
    straight = advance(channel(flows, f"precision={precision}"), steps)
    again = flows.empty(CHANNEL, f"precision={precision}")
    assert again.restore(straight.checkpoint())
    assert_same_bits(straight.checkpoint(), again.checkpoint())
    for simulation in (straight, again):
        advance(simulation, STEPS)
    assert straight.rebuilds > 2
    assert straight.totals()["mass_entered"] > 0
    assert straight.steps == again.steps == steps + STEPS
    assert_same_bits(result(straight), result(again))
    assert_same_bits(straight.checkpoint(), again.checkpoint())


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("isa", INSTRUCTION_SETS)
@pytest.mark.isa
def test_instruction_set_changes_only_rounding(core, flows, isa, dim):
    """Sums in another order: 1e-9 of its scale in every field after some tens of steps."""
    text = FILM.format(dim=dim)
    expected, state = (
        advance(flows(text, isa=kind), STEPS // 3).state() for kind in ("scalar", isa)
    )
    for name, scale in (("position", 0.01), ("velocity", 1.0), ("density", 1000.0)):
        np.testing.assert_allclose(state[name], expected[name], rtol=0, atol=1e-9 * scale)
    force = np.abs(expected["force"]).max()
    np.testing.assert_allclose(state["force"], expected["force"], rtol=0, atol=1e-8 * force)


@pytest.mark.parametrize("skin", [0.0, 0.3])
@pytest.mark.parametrize("text", [FILM.format(dim=2), CHANNEL], ids=["film", "turbulent channel"])
def test_margin_of_the_lists_changes_only_rounding(core, flows, text, skin):
    expected, state = (
        advance(flows(text, f"skin={margin}"), STEPS // 2).state() for margin in (0.1, skin)
    )
    moved = state["position"] - expected["position"]
    np.testing.assert_allclose(unperiodic(moved), 0, rtol=0, atol=1e-11)
    np.testing.assert_allclose(state["velocity"], expected["velocity"], rtol=0, atol=1e-9)


def unperiodic(moved):
    """When a particle comes back at the other side of the period is up to the lists."""
    moved[:, 0] -= PERIOD * np.round(moved[:, 0] / PERIOD)
    return moved


@pytest.mark.parametrize("dim", [2, 3])
def test_mixed_precision_changes_only_rounding(flows, dim):
    """That of single precision, after some tens of steps."""
    text = FILM.format(dim=dim)
    double, mixed = (
        advance(flows(text, f"precision={kind}"), STEPS // 6).state() for kind in PRECISIONS
    )
    moved = mixed["position"] - double["position"]
    np.testing.assert_allclose(unperiodic(moved), 0, rtol=0, atol=1e-6 * 0.01)
    np.testing.assert_allclose(mixed["velocity"], double["velocity"], rtol=0, atol=1e-5)
    np.testing.assert_allclose(mixed["density"], double["density"], rtol=1e-6)
    assert not np.array_equal(mixed["velocity"], double["velocity"])


def test_a_double_run_goes_on_in_mixed_precision(flows):
    double = advance(flows(CHANNEL), STEPS)
    mixed = flows.empty(CHANNEL, "precision=mixed")
    assert not mixed.restore(double.checkpoint()), "lists of other lanes are made anew"
    one, other = (advance(simulation, 10).state() for simulation in (double, mixed))
    np.testing.assert_array_equal(one["id"], other["id"])
    np.testing.assert_allclose(one["velocity"], other["velocity"], rtol=0, atol=1e-3)


@pytest.mark.parametrize("kernel", ["wendland_c2", "wendland_c6"])
def test_a_film_runs_in_3d(core, flows, kernel):
    """It keeps its depth and its mass, and gravity draws it down the slope."""
    settings = ["body.film.velocity=[0, 0, 0]", "body.bed.wall=free_slip", f'kernel="{kernel}"']
    film = advance(flows(FILM.format(dim=3), *settings), 200)
    state = film.state()
    free = state["motion"] == 0
    assert state["velocity"][free, 0].mean() < -0.5 * 9.8 * np.sin(np.radians(20)) * film.time
    assert 0.02 < state["position"][free, 2].max() < 0.05
    np.testing.assert_allclose(state["density"][free], 1000, rtol=0.02)
