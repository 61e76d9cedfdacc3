"""Artificial viscosity: approach speed, signal velocity and the sign of Pi."""

from __future__ import annotations

import numpy as np
import pytest


def test_approach_speed_is_the_component_along_the_pair(point):
    w = point("approach_speed", [-6.0, -0.5], [2.0, 0.25])[0]
    np.testing.assert_array_equal(w, [-3.0, -2.0])


def test_receding_pairs_do_not_approach(point):
    w = point("approach_speed", [0.0, 1e-300, 5.0], 0.1)[0]
    np.testing.assert_array_equal(w, 0)


def test_signal_velocity_is_equation_15(point):
    v_sig = point("signal_velocity", [70.0, 70.0], [264.0, 264.0], [0.0, -2.0])[0]
    np.testing.assert_allclose(v_sig, [334.0, 340.0])


def test_viscosity_is_equation_13(point):
    Pi = point("artificial_viscosity", 0.7, 340.0, -2.0, 1000.0, 2750.0)[0, 0]
    rho_ij = 0.5 * (1000 + 2750)
    assert Pi == pytest.approx(0.7 * 340 * 2 / (2 * rho_ij), rel=1e-15)


def test_viscosity_is_repulsive_for_approaching_pairs_only(point, random):
    w = point("approach_speed", random.normal(size=100), 0.01)[0]
    v_sig = point("signal_velocity", 70.0, 70.0, w)[0]
    Pi = point("artificial_viscosity", 1.0, v_sig, w, 1000.0, 1000.0)[0]
    assert (Pi[w < 0] > 0).all()
    assert (Pi[w == 0] == 0).all()
    assert (w < 0).any()
    assert (w == 0).any()


def test_is_the_same_seen_from_either_particle(point, random):
    """r_ij and v_ij change sign together; c and rho enter in both orders."""
    r_ij, v_ij = random.normal(size=(2, 3, 50))
    rho, c = random.uniform(900, 2800, (2, 50)), random.uniform(50, 300, (2, 50))
    r = np.linalg.norm(r_ij, axis=0)
    seen = []
    for i, sign in ((0, 1), (1, -1)):
        j = 1 - i
        w = point("approach_speed", np.sum(sign * v_ij * (sign * r_ij), axis=0), r)[0]
        v_sig = point("signal_velocity", c[i], c[j], w)[0]
        seen.append(point("artificial_viscosity", 1.0, v_sig, w, rho[i], rho[j])[0])
    np.testing.assert_array_equal(*seen)
