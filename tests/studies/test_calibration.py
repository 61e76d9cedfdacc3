"""Optimisers of scipy on an analytic stand-in for runs; test_recovery.py has real ones."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from doseki.studies.calibration import METHODS, calibrated
from doseki.studies.plan.axes import Axis
from doseki.studies.plan.file import read_plan
from doseki.studies.plan.tables import Calibrate
from doseki.studies.runs.row import DONE, FAILED, Row
from doseki.studies.study import _calibration_lines

from .small_study import write_study

KS = Axis("ks", low=0.002, high=0.02, log=True)
TAU = Axis("tau_y", low=5.0, high=60.0)
TRUE = {"ks": 0.0083, "tau_y": 22.0}


class Bowl:
    """Rows whose score is least at TRUE; runs with much roughness fail."""

    def __init__(self, axes):
        self.axes, self.asked, self.batches = axes, [], []

    def rows(self, points):
        self.asked += points
        self.batches.append(len(points))
        return [self._row(point) for point in points]

    def _row(self, point):
        if point[0] > 0.015:
            return Row(FAILED, "", "a particle is lost")
        away = [
            math.log(value / TRUE[axis.name]) for axis, value in zip(self.axes, point, strict=True)
        ]
        return Row(DONE, "", score=0.05 + math.hypot(*away))


@pytest.mark.parametrize("axes", [[KS], [KS, TAU]], ids=["one value", "two values"])
@pytest.mark.parametrize("method", METHODS)
def test_the_least_score_is_found(method, axes):
    bowl = Bowl(axes)
    found = calibrated(axes, bowl, Calibrate(method=method, max_runs=70 * len(axes)))
    for axis, value in zip(axes, found.point, strict=True):
        assert value == pytest.approx(TRUE[axis.name], rel=0.03)
    assert found.score == pytest.approx(0.05, abs=0.03)
    assert len(bowl.asked) == len(set(bowl.asked)) == found.runs <= 70 * len(axes)


def test_a_generation_runs_together():
    bowl = Bowl([KS])
    calibrated([KS], bowl, Calibrate(method="differential_evolution", max_runs=30, population=6))
    assert bowl.batches[0] == 6
    assert max(bowl.batches[1:]) > 1


def test_the_same_seed_asks_for_the_same_runs():
    asked = []
    for seed in (1, 1, 2):
        bowl = Bowl([KS])
        calibrated([KS], bowl, Calibrate(method="differential_evolution", max_runs=20, seed=seed))
        asked.append(bowl.asked)
    assert asked[0] == asked[1] != asked[2]


def test_no_more_runs_than_allowed_and_it_says_so():
    bowl = Bowl([KS])
    found = calibrated([KS], bowl, Calibrate(method="dual_annealing", max_runs=5))
    assert len(bowl.asked) == found.runs == 5
    assert not found.converged
    assert "max_runs = 5" in found.message


def test_a_population_that_has_met_ends():
    how = Calibrate(method="differential_evolution", max_runs=500, tolerance=0.3)
    found = calibrated([KS], Bowl([KS]), how)
    assert found.converged
    assert found.runs < 100


def test_without_a_score_there_is_no_best():
    axis = Axis("ks", low=0.016, high=0.02)
    found = calibrated([axis], Bowl([axis]), Calibrate(method="shgo", max_runs=10))
    assert found.point is None
    assert math.isnan(found.score)


def test_runs_of_a_sample_may_be_the_best():
    sample = [(0.0083,)]
    how = Calibrate(method="differential_evolution", max_runs=8)
    found = calibrated([KS], Bowl([KS]), how, sample)
    assert found.point == sample[0]
    assert (found.runs, found.sampled) == (9, 1)


def test_runs_of_a_sample_are_told_apart(tmp_path):
    """They are not counted against max_runs."""
    sample = [(0.0083,), (0.004,), (0.0083,)]
    how = Calibrate(method="dual_annealing", max_runs=5)
    found = calibrated([KS], Bowl([KS]), how, sample)
    plan = read_plan(write_study(tmp_path))
    said = next(_calibration_lines(replace(found, point=(0.0083,)), plan))
    assert "after 5 runs and 2 of the sample; max_runs = 5 were made" in said
