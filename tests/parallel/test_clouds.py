"""Clouds with nothing regular in them: the same on any number of ranks."""

from __future__ import annotations

import pytest

# Sums of some hundred terms in another order; a float has 6e-8.
ROUNDING = {"double": 1e-12, "mixed": 1e-5}


def assert_same(found, ranks):
    """Neighbours exactly, rates and fields to rounding, all ranks at work."""
    assert len(found) == 18
    for case in found:
        assert case["counts"], case
        assert case["mean_count"] > 15
        assert case["rates"] < ROUNDING[case["case"][1]], case
        assert case["fields"] < ROUNDING[case["case"][1]], case
        assert len(case["held"]) == ranks
        assert min(case["held"]) > 0
        assert min(case["ghosts"]) > 0


@pytest.mark.parametrize("ranks", [2, 3])
def test_clouds_on_ranks_are_those_of_one(work, ranks):
    assert_same(work("clouds_on_ranks", ranks, "multisection"), ranks)


@pytest.mark.ranks
def test_clouds_on_four_ranks(work):
    assert_same(work("clouds_on_ranks", 4, "multisection"), 4)


@pytest.mark.parametrize("ranks", [2, 3])
def test_clouds_cut_by_zoltan(open_mpi, ranks):
    assert_same(open_mpi("clouds_on_ranks", ranks, "zoltan"), ranks)
