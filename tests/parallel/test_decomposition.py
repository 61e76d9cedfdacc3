"""Space cut into parts of equal weight."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.parallel.decomposition import best_counts, multisect, quantiles, sample


def test_quantiles_halve_a_line_by_weight():
    x = np.array([3.0, 1.0, 2.0, 4.0])
    np.testing.assert_allclose(quantiles(x, np.ones(4), 2), [2.5])
    np.testing.assert_allclose(quantiles(x, np.ones(4), 4), [1.5, 2.5, 3.5])
    np.testing.assert_allclose(quantiles(x, np.array([1.0, 5.0, 1.0, 1.0]), 2), [1.5])
    assert len(quantiles(np.zeros(0), np.zeros(0), 3)) == 2


@pytest.mark.parametrize(("ranks", "counts"), [(1, (1, 1)), (3, (3, 1)), (4, (4, 1)), (16, (8, 2))])
def test_a_long_box_is_cut_across_its_length(ranks, counts):
    assert best_counts(ranks, np.array([4.0, 1.0])) == counts


def test_a_cube_is_cut_along_all_axes():
    assert sorted(best_counts(24, np.ones(3))) == [2, 3, 4]
    assert best_counts(8, np.ones(3)) == (2, 2, 2)


def test_a_plane_of_points_is_not_cut_along_its_normal():
    assert best_counts(16, np.array([1.0, 0.0, 1.0])) == (4, 1, 4)


def test_parts_have_equal_weight():
    random = np.random.default_rng(0)
    points, weights = random.normal(size=(40_000, 3)), random.uniform(0, 1, 40_000)
    x, y, z = multisect(points, weights, (3, 2, 2))
    assert [cuts.shape for cuts in (x, y, z)] == [(1, 2), (3, 1), (6, 1)]
    slab = np.searchsorted(x[0], points[:, 0], side="right")
    half = 2 * slab + (points[:, 1] >= y[slab, 0])
    part = 2 * half + (points[:, 2] >= z[half, 0])
    share = np.bincount(part, weights=weights)
    assert len(share) == 12
    np.testing.assert_allclose(share / share.mean(), 1, atol=1e-3)


def test_a_sample_keeps_the_weight_and_its_place():
    random = np.random.default_rng(0)
    points, weights = random.uniform(size=(5000, 2)), random.uniform(0, 1, 5000)
    points = points[np.argsort(points[:, 0])]
    chosen, weight = sample(points, weights, 200)
    assert weight.sum() == pytest.approx(weights.sum())
    mean = np.average(points[:, 0], weights=weights)
    assert np.average(chosen[:, 0], weights=weight) == pytest.approx(mean, abs=0.005)


def assert_good(found, engines, imbalance):
    """Balanced parts, whose answers fit together."""
    assert [(case["engine"], case["dim"]) for case in found] == [
        (engine, dim) for dim in (2, 3) for engine in engines
    ]
    for case in found:
        assert case["imbalance"] < imbalance[case["engine"]], case
        assert case["strays"] <= 4, case
        assert case["touched"], case
        assert case["same_everywhere"], case


def test_ranks_cut_space_together(work):
    assert_good(work("cuts", 2), ["multisection"], {"multisection": 1.03})


def test_zoltan_and_multisection_do_the_same(open_mpi):
    limits = {"multisection": 1.05, "zoltan": 1.001}
    assert_good(open_mpi("cuts", 4), ["multisection", "zoltan"], limits)
