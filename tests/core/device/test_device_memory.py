"""What the code of a card takes of its memory, measured on the processor."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.bench.case import Case, make_simulation
from doseki.compiled import available_instruction_sets

HAS_DEVICE = "device" in available_instruction_sets()
pytestmark = [
    pytest.mark.isa,
    pytest.mark.skipif(not HAS_DEVICE, reason="the core was not built for --device host"),
]
SLICE = 2**18  # rows that are summed at once
ENTRY = 4  # bytes


def stepped(case, steps):
    simulation = make_simulation(case)
    simulation.advance(limit=1e30, pause=1e30, max_steps=steps)
    return simulation


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("scheme", ["resolved", "ueta2022"])
def test_lists_that_are_built_anew_take_no_more_than_they_hold(scheme, dim):
    """They took up to twice that, as soon as one was longer than that before."""
    simulation = make_simulation(Case(dim, 8000, "double", 1, "device", scheme=scheme))
    without_lists = []
    while simulation.rebuilds < 5:
        simulation.advance(limit=1e30, pause=1e30, max_steps=1)
        of_lists = ENTRY * simulation.entries_per_particle
        without_lists.append(simulation.bytes_per_particle - of_lists)
    assert max(without_lists) - min(without_lists) < 0.1 * of_lists


@pytest.mark.minutes
@pytest.mark.parametrize("scheme", ["resolved", "ueta2022"])
def test_slices_of_rows(scheme):
    """More particles than are summed at once: fields and timestep are those of the processor."""
    n = SLICE + 1000
    isas = ("device", available_instruction_sets()[0])
    device, processor = (stepped(Case(2, n, "double", 1, isa, scheme=scheme), 2) for isa in isas)
    assert device.time == pytest.approx(processor.time, rel=1e-12)
    one, other = device.state(), processor.state()
    assert np.array_equal(one["id"], other["id"])
    assert np.abs(one["position"] - other["position"]).max() < 1e-12
    assert np.abs(one["velocity"] - other["velocity"]).max() < 1e-9
