"""The largest part of a disc that strikes a plate, against the energy of the impact."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.grading import grading_of
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

SPEEDS = (2.0, 4.0, 8.0)  # m/s

pytestmark = pytest.mark.minutes


@pytest.fixture(scope="module")
def gradings(tmp_path_factory):
    """Grading at the end by speed."""
    found = {}
    for speed in SPEEDS:
        folder = tmp_path_factory.mktemp("drop") / "run"
        settings = [f"speed={speed}", "across=24", "time_max=0.0004", "time_out=0.0004"]
        run_scenario(load_scenario("drop-weight", settings), folder, RunOptions(threads=1))
        found[speed] = grading_of(load(folder)[-1])
    return found


def test_it_falls_with_the_speed(gradings):
    """The slowest leaves the disc whole."""
    largest = [gradings[speed].mass.max() / gradings[speed].mass.sum() for speed in SPEEDS]
    assert largest[0] == 1
    assert (np.diff(largest) < 0).all()
    assert largest[-1] < 0.3


def test_gradings_become_finer(gradings):
    """Half of the mass is in smaller parts; none is lost."""
    medians = [
        gradings[speed].size[np.searchsorted(gradings[speed].finer, 0.5)] for speed in SPEEDS
    ]
    assert (np.diff(medians) < 0).all()
    whole = gradings[SPEEDS[0]].mass.sum()
    for grading in gradings.values():
        assert grading.mass.sum() == pytest.approx(whole, rel=1e-12)
        assert grading.finer[-1] == pytest.approx(1)
