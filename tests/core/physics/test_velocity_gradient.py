"""The Balsara switch: its limits, and that it sees every component of the curl."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

NOISE = 1e-4  # the switch compares with this times c/h


def balsara(point, L, dim, c=100.0, h=0.01):
    """The switch of one velocity gradient (dim, dim)."""
    return point("balsara_switch", *np.ravel(L), c, h, dim=dim)[0, 0]


def test_is_open_in_compression(point, dim):
    """|div| / (|div| + 1e-4 c/h), the same for expansion."""
    L = -50.0 * np.eye(dim)
    expected = 50 * dim / (50 * dim + NOISE * 100.0 / 0.01)
    assert balsara(point, L, dim) == pytest.approx(expected, rel=1e-15)
    assert balsara(point, -L, dim) == pytest.approx(expected, rel=1e-15)
    assert expected > 0.98


def test_is_shut_in_shear_and_rotation(point, dim):
    L = np.zeros((dim, dim))
    L[0, 1] = 50.0
    assert balsara(point, L, dim) == 0
    L[1, 0] = -50.0
    assert balsara(point, L, dim) == 0


def test_is_shut_at_rest(point, dim):
    assert balsara(point, np.zeros((dim, dim)), dim) == 0


def test_pure_strain_is_no_curl(point, dim):
    """Symmetric parts of L cancel in the curl."""
    L = np.full((dim, dim), 30.0)
    expected = 30 * dim / (30 * dim + NOISE * 100.0 / 0.01)
    assert balsara(point, L, dim) == pytest.approx(expected, rel=1e-15)


def test_weighs_compression_against_curl(point, dim):
    """|div| = |curl| gives one half, for the curl about each axis, whatever the sign."""
    for a, b in itertools.permutations(range(dim), 2):
        L = np.diag([40.0] + [0.0] * (dim - 1))
        L[a, b] += 40.0
        assert balsara(point, L, dim, c=1e-12) == pytest.approx(0.5, rel=1e-12)


def test_curl_is_a_length(point):
    """In 3-D the components of the curl add as squares: (2, 3, 6) is 7 long."""
    L = np.zeros((3, 3))
    L[2, 1], L[0, 2], L[1, 0] = 2.0, 3.0, 6.0
    L[0, 0] = 7.0
    assert balsara(point, L, 3, c=1e-12) == pytest.approx(0.5, rel=1e-12)


def test_noise_scale_is_sound_over_smoothing_length(point, dim):
    """Where |div| = 1e-4 c/h the switch is half open."""
    L = np.diag([NOISE * 70.0 / 0.02] + [0.0] * (dim - 1))
    assert balsara(point, L, dim, c=70.0, h=0.02) == pytest.approx(0.5, rel=1e-14)


def test_stays_between_zero_and_one(point, dim, random):
    L = random.normal(size=(dim * dim, 300)) * 10.0 ** random.integers(-6, 7, (dim * dim, 300))
    f = point("balsara_switch", *L, 70.0, 0.01, dim=dim)[0]
    assert ((f >= 0) & (f <= 1)).all()
