"""Turbulence, free surface and shifting: functions of single particles of the resolved scheme."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

KERNELS = {  # name, name of its lattice sums, support in spacings
    False: ("wendland_c2", "lattice_sums_c2", 2.78),
    True: ("kernel", "lattice_sums_c6", 3.0),
}
WIDE = pytest.mark.parametrize("wide", [False, True], ids=["c2", "c6"])


def rows(values):
    """The columns of an array of vectors."""
    return list(np.asarray(values).reshape(len(values), -1).T)


# Turbulence


def test_strain_rate_of_simple_shear_is_its_rate(point, dim):
    """And a rigid rotation has none."""
    shear, turn = np.zeros((2, dim, dim))
    shear[0, 1] = 7.0
    turn[0, 1], turn[1, 0] = 4.0, -4.0
    (rate,) = point("strain_rate", *rows(np.stack([shear, shear.T, turn])), dim=dim)
    np.testing.assert_allclose(rate, [7, 7, 0], rtol=1e-15)


def test_strain_rate_is_the_norm_of_the_symmetric_part(point, dim, random):
    L = random.normal(size=(30, dim, dim))
    D = 0.5 * (L + L.transpose(0, 2, 1))
    (rate,) = point("strain_rate", *rows(L), dim=dim)
    np.testing.assert_allclose(rate, np.sqrt(2 * np.einsum("nab,nab->n", D, D)), rtol=1e-13)


def test_mixing_length_gives_the_logarithmic_profile(point):
    """l^2 |du/dz|^2 = u*^2 (1 - z/d) with du/dz = u*/(kappa z)."""
    d, u_star = 0.3, 0.11
    z = d * np.linspace(0.01, 0.99, 50)
    (length,) = point("mixing_length", z, d, 0.0)
    stress = (length * u_star / (0.4 * z)) ** 2
    np.testing.assert_allclose(stress, u_star**2 * (1 - z / d), rtol=1e-12)


def test_mixing_length_is_no_less_than_the_least(point):
    (length,) = point("mixing_length", [-1.0, 0.0, 0.3, 5.0, 0.1], [0.3, 0.3, 0.3, 0.3, 0.0], 1e-3)
    np.testing.assert_array_equal(length, 1e-3)


# Free surface


def half_space(point, dim, wide, row, dilution=1.0):
    """Indicator and normalised density at a row (0: topmost) of a lattice under a flat surface."""
    kernel, sums, R = KERNELS[wide]
    x = np.array(list(product(range(-4, 5), repeat=dim)), float)
    x = x[x[:, -1] <= row]
    W, F = point(kernel, np.linalg.norm(x, axis=1), 1 / R, dim=dim)
    (full,), (moment,) = point(sums, 1.0, R, dim=dim)
    slope = np.linalg.norm((F[:, None] * x).sum(axis=0)) / moment
    (indicator,), (density,) = point(
        "free_surface_indicator", dilution * W.sum() / full, dilution * R * slope, float(wide)
    )
    return indicator, density


@WIDE
@pytest.mark.parametrize("row", [0, 1, 2, 3])
def test_normalised_density_is_one_under_a_flat_surface(point, dim, wide, row):
    indicator, density = half_space(point, dim, wide, row)
    assert density == pytest.approx(1, abs=0.02)
    assert (indicator > 0.9) == (row == 0)


@WIDE
def test_dilution_changes_the_normalised_density_alone(point, dim, wide):
    """Water that has swelled is no nearer to its surface."""
    for row in range(4):
        indicator, density = half_space(point, dim, wide, row)
        thin_indicator, thin_density = half_space(point, dim, wide, row, dilution=0.9)
        assert thin_indicator == pytest.approx(indicator, rel=1e-12)
        assert thin_density == pytest.approx(0.9 * density, rel=1e-12)


@WIDE
def test_spray_and_corners_have_no_density_to_correct(point, wide):
    indicator, density = point(
        "free_surface_indicator", [0.59, 0.59, 0.8, 0.8], [0, 9, 2, 5], float(wide)
    )
    np.testing.assert_allclose(indicator, [3, 3, 2.5, 3])
    np.testing.assert_array_equal(density, 1)


# Moments


def test_inverse_moment_is_the_inverse(point, dim, random):
    A = random.normal(size=(40, dim, dim))
    m = np.eye(dim) + A @ A.transpose(0, 2, 1)
    pairs = [(a, a) for a in range(dim)] + [(0, 1), (0, 2), (1, 2)][: dim * (dim - 1) // 2]
    inverse = point("inverse_moment", *[m[:, a, b] for a, b in pairs], dim=dim)
    product_ = np.einsum("nab,nbc->nac", m, inverse.T.reshape(-1, dim, dim))
    np.testing.assert_allclose(product_, np.broadcast_to(np.eye(dim), m.shape), atol=1e-12)


def test_particles_that_do_not_span_the_space_have_no_inverse(point, dim):
    diagonal = np.ones((dim, 2))
    diagonal[-1] = [0.049, 0.051]
    inverse = point("inverse_moment", *diagonal, *np.zeros((dim * (dim - 1) // 2, 2)), dim=dim)
    assert (inverse[:, 0] == 0).all()
    assert inverse[-1, 1] == pytest.approx(1 / 0.051)


# Shifting


def test_shifting_goes_down_the_gradient_at_its_speed(point, dim, random):
    """-80 h^2 |L| grad C, at most 10 h |L|."""
    h, rate = 0.013, 25.0
    gradient = random.normal(size=(40, dim)) * np.geomspace(1e-3, 1e3, 40)[:, None]
    shift = point("shifting_velocity", rate, h, *rows(gradient), dim=dim).T
    length = np.linalg.norm(gradient, axis=1)
    speed = np.minimum(80 * h**2 * rate * length, 10 * h * rate)
    assert (speed < 10 * h * rate).any()
    assert (speed == 10 * h * rate).any()
    np.testing.assert_allclose(shift, -(speed / length)[:, None] * gradient, rtol=1e-12)


def test_shifting_without_gradient_is_none(point, dim):
    shift = point("shifting_velocity", 25.0, 0.013, *np.zeros(dim), dim=dim)
    np.testing.assert_array_equal(shift, 0)


def test_tangential_takes_out_what_is_along_the_normal(point, dim, random):
    v, n = random.normal(size=(2, 40, dim))
    along = point("tangential", *rows(v), *rows(n), dim=dim).T
    np.testing.assert_allclose((along * n).sum(axis=1), 0, atol=1e-13)
    lengths = np.linalg.norm(v - along, axis=1) * np.linalg.norm(n, axis=1)
    np.testing.assert_allclose(np.abs(((v - along) * n).sum(axis=1)), lengths, rtol=1e-12)
    np.testing.assert_array_equal(point("tangential", *rows(v), *np.zeros(dim), dim=dim).T, v)
