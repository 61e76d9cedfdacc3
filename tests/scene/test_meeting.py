"""Boxes that meet, found by a sweep, against all pairs."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scene.meeting import meeting_pairs


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("size", [0.02, 0.2, 2.0])
def test_the_same_pairs_as_all_that_meet_in_the_same_order(dim, size):
    random = np.random.default_rng(dim)
    low = random.uniform(0, 1, (120, dim))
    high = low + random.uniform(0, size, (120, dim))
    low[7] = low[3]  # as a tie along the sweep
    met = [
        (i, j)
        for i in range(120)
        for j in range(i + 1, 120)
        if (low[i] <= high[j]).all() and (low[j] <= high[i]).all()
    ]
    assert [tuple(pair) for pair in meeting_pairs(low, high)] == met


def test_boxes_that_touch_meet_and_none_alone():
    low = np.array([[0.0, 0.0], [1.0, 0.0], [2.5, 0.0]])
    assert meeting_pairs(low, low + 1).tolist() == [[0, 1]]
    assert meeting_pairs(low[:0], low[:0]).shape == (0, 2)
