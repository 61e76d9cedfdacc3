"""Yield surfaces and return maps against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from .test_stress import N, full, random_deviator, stored

COHESION, ANGLE = 5e3, np.radians(30)


def returned(point, S, p, surface, dim):
    """(n, 3, 3) deviators after the return map."""
    return full(point("return_map", *stored(S, dim), p, *surface, dim=dim), dim)


def von_mises(point, strength):
    """(alpha, k) as numbers."""
    return np.ravel(point.physics.von_mises([[strength]]))


def drucker_prager(point, dim, cohesion=COHESION, angle=ANGLE):
    """(alpha, k) as numbers."""
    return point("drucker_prager", cohesion, angle, dim=dim)[:, 0]


def root_j2(S):
    """sqrt(S:S/2)."""
    return np.sqrt(0.5 * np.sum(S * S, axis=(1, 2)))


@pytest.mark.parametrize("pressure", [0.0, 1e6])
def test_pure_shear_yields_at_y_over_root_three(point, dim, pressure):
    shear = np.array([0.1, 0.57, 0.58, 3.0, -3.0]) * 1e6
    S = np.zeros((5, 3, 3))
    S[:, 0, 1] = S[:, 1, 0] = shear
    mapped = returned(point, S, pressure, von_mises(point, 1e6), dim)
    limit = 1e6 / np.sqrt(3)
    np.testing.assert_allclose(mapped[:, 0, 1], np.clip(shear, -limit, limit), rtol=1e-14)
    np.testing.assert_allclose(mapped[:, 0, 0], 0, atol=1e-9)


def test_uniaxial_compression_yields_at_y(point, dim):
    """sigma = diag(-s, 0, 0) has S = diag(-2, 1, 1) s/3 and s = Y at yield."""
    s = np.array([0.5, 0.99, 1.01, 40.0]) * 1e6
    S = s[:, None, None] / 3 * np.diag([-2.0, 1.0, 1.0])
    mapped = returned(point, S, s / 3, von_mises(point, 1e6), dim)
    difference = mapped[:, 1, 1] - mapped[:, 0, 0]
    np.testing.assert_allclose(difference, np.minimum(s, 1e6), rtol=1e-14)


def test_cone_of_plane_strain(point):
    """Bui et al. 2008: alpha = tan/sqrt(9 + 12 tan^2), k = 3c/sqrt(9 + 12 tan^2); tan^2 = 1/3."""
    alpha, k = drucker_prager(point, 2)
    np.testing.assert_allclose([alpha, k], [1 / np.sqrt(39), 3 * COHESION / np.sqrt(13)])


def test_cone_in_3d_meets_mohr_coulomb_in_compression(point):
    """Triaxial compression: sigma_1 = sigma_3 (1 + sin)/(1 - sin) + 2 c cos/(1 - sin)."""
    side = np.array([0.0, 1e3, 1e5])
    top = (side * (1 + np.sin(ANGLE)) + 2 * COHESION * np.cos(ANGLE)) / (1 - np.sin(ANGLE))
    p = (top + 2 * side) / 3
    alpha, k = drucker_prager(point, 3)
    np.testing.assert_allclose((top - side) / np.sqrt(3), k + 3 * alpha * p, rtol=1e-12)


@pytest.mark.parametrize("cohesion", [0.0, COHESION])
def test_pure_shear_under_pressure_is_coulomb(point, dim, cohesion):
    surface = drucker_prager(point, dim, cohesion)
    p = np.array([0.0, 1e3, 1e5])
    S = np.zeros((3, 3, 3))
    S[:, 0, 1] = S[:, 1, 0] = 1e9
    mapped = returned(point, S, p, surface, dim)
    np.testing.assert_allclose(mapped[:, 0, 1], surface[1] + 3 * surface[0] * p, rtol=1e-13)


def test_maps_are_idempotent_and_along_the_ray(point, dim, random):
    S, p = 1e5 * random_deviator(random, dim), 1e4 * random.random(N)
    for surface in (von_mises(point, 1e5), drucker_prager(point, dim)):
        once = returned(point, S, p, surface, dim)
        np.testing.assert_allclose(returned(point, once, p, surface, dim), once, rtol=1e-14)
        assert np.all(root_j2(once) <= (surface[1] + 3 * surface[0] * p) * (1 + 1e-14))
        ratio = root_j2(once) / root_j2(S)
        assert ratio.min() < 0.5
        np.testing.assert_allclose(once, ratio[:, None, None] * S, rtol=0, atol=1e-6)


def test_inside_nothing_changes(point, dim, random):
    S = random_deviator(random, dim)
    for surface in (von_mises(point, 1e5), drucker_prager(point, dim), (0.0, np.inf)):
        np.testing.assert_array_equal(returned(point, S, 0.0, surface, dim), S)


def test_no_stress_stays_none(point, dim):
    S = np.zeros((1, 3, 3))
    assert not returned(point, S, 0.0, drucker_prager(point, dim, 0.0), dim).any()


def test_tension_never_goes_beyond_the_cut(point, dim):
    alpha, k = drucker_prager(point, dim)
    p = np.array([-1e9, -k / (3 * alpha) * 1.001, -10.0, 0.0, 1e9])
    cut = point("tension_cut", p, alpha, k)[0]
    np.testing.assert_allclose(cut, np.maximum(p, -k / (3 * alpha)), rtol=1e-14)
    at_apex = returned(
        point, np.full((1, 3, 3), 0.0) + np.diag([1.0, -1.0, 0.0]), cut[:1], (alpha, k), dim
    )
    np.testing.assert_allclose(at_apex, 0, atol=1e-11)


@pytest.mark.parametrize("k", [1e4, np.inf])
def test_von_mises_and_elastic_solids_have_no_cut(point, k):
    np.testing.assert_array_equal(point("tension_cut", np.array([-1e9, 1.0]), 0.0, k)[0], [-1e9, 1])
