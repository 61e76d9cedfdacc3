"""Depths of columns."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.columns import column_depth


def lattice(*sizes):
    axes = np.meshgrid(*map(np.arange, sizes), indexing="ij")
    return 0.1 * (np.stack(axes, axis=-1).reshape(-1, len(sizes)) + 0.5)


@pytest.mark.parametrize("dim", [2, 3])
def test_depth_is_the_volume_over_the_area(dim):
    position = lattice(*[20, 10][: dim - 1], 7)
    volume = np.full(len(position), 0.1**dim)
    for shift in (0.0, 1.0, 4.6e5):  # whole cells: nothing changes
        moved = position + shift * np.eye(dim)[0]
        assert np.allclose(column_depth(moved, volume, 0.5), 0.7)
    assert np.allclose(column_depth(position + 0.3 * np.eye(dim)[-1], volume, 0.5), 0.7)
    assert np.allclose(column_depth(position, 2 * volume, 0.5), 1.4)


def test_columns_are_apart():
    position = np.concatenate([lattice(10, 4), lattice(10, 8) + np.array([1.0, 0.0])])
    depth = column_depth(position, np.full(len(position), 0.01), 0.5)
    assert np.allclose(depth, np.where(position[:, 0] < 1.0, 0.4, 0.8))


def test_nothing_has_no_depth():
    assert column_depth(np.zeros((0, 3)), np.zeros(0), 1.0).shape == (0,)
