"""The time step of Eq. (18)."""

from __future__ import annotations

import pytest


def test_acoustic_limit(point):
    """C_CFL 2h / v_sig, here with next to no acceleration."""
    dt = point("timestep", 0.012, 334.0, 1e-3, 0.1, 0.1)[0, 0]
    assert dt == pytest.approx(0.1 * 2 * 0.012 / 334, rel=1e-15)


def test_force_limit(point):
    """C_f sqrt(h/|a|), here for a hard push."""
    dt = point("timestep", 0.012, 334.0, 1e8, 0.2, 0.3)[0, 0]
    assert dt == pytest.approx(0.3 * (0.012 / 1e8) ** 0.5, rel=1e-15)


def test_the_smaller_limit_counts(point):
    """They meet at |a| = h (C_f v_sig / (2 h C_CFL))^2."""
    meeting = 0.012 * (334.0 / (2 * 0.012)) ** 2
    below, above = point("timestep", 0.012, 334.0, [0.25 * meeting, 4 * meeting], 0.1, 0.1)[0]
    assert below == pytest.approx(0.1 * 2 * 0.012 / 334, rel=1e-14)
    assert above == pytest.approx(0.5 * below, rel=1e-14)


def test_no_force_sets_no_limit(point):
    dt = point("timestep", 0.012, 334.0, 0.0, 0.1, 0.1)[0, 0]
    assert dt == pytest.approx(0.1 * 2 * 0.012 / 334, rel=1e-15)
