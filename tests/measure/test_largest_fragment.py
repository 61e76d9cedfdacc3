"""The largest part of a disc that strikes a plate, against the energy of the impact."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.grading import grading_of
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

SPEEDS = (2.0, 3.0, 12.0)  # m/s
TURNS = (10, 27, 44)  # of the lattice of the disc, degrees: the largest part of one scatters by 2

pytestmark = pytest.mark.minutes


@pytest.fixture(scope="module")
def gradings(tmp_path_factory):
    """Gradings at the end by speed, one for each turn."""
    return {
        speed: [broken(tmp_path_factory.mktemp("drop"), speed, turn) for turn in TURNS]
        for speed in SPEEDS
    }


def broken(folder, speed, turn):
    settings = [f"speed={speed}", f"turn={turn}", "across=24", "time_max=0.0004"]
    scenario = load_scenario("drop-weight", [*settings, "time_out=0.0004"])
    run_scenario(scenario, folder / "run", RunOptions(threads=1))
    return grading_of(load(folder / "run")[-1], set())


def test_it_falls_with_the_speed(gradings):
    """The slowest leaves the disc whole."""
    largest = [
        np.mean([grading.mass.max() / grading.mass.sum() for grading in gradings[speed]])
        for speed in SPEEDS
    ]
    assert largest[0] == 1
    assert (np.diff(largest) < -0.2).all()
    assert largest[-1] < 0.25


def test_gradings_become_finer(gradings):
    """Half of the mass is in smaller parts; none is lost."""
    medians = [
        np.mean([grading.size[np.searchsorted(grading.finer, 0.5)] for grading in gradings[speed]])
        for speed in SPEEDS
    ]
    assert (np.diff(medians) < 0).all()
    whole = gradings[SPEEDS[0]][0].mass.sum()
    for grading in [each for of_speed in gradings.values() for each in of_speed]:
        assert grading.mass.sum() == pytest.approx(whole, rel=1e-12)
        assert grading.finer[-1] == pytest.approx(1)
