"""The Wendland C2 kernel by calculus, and what lattices make of both kernels."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

SUPPORT = pytest.mark.parametrize("R", [1.0, 0.03, 7.5])
SPHERE = {2: 2 * np.pi, 3: 4 * np.pi}  # area of the unit sphere


def radial_integral(values, r, weights, dim):
    """Integral over space of a function of r, given at the nodes of a quadrature."""
    return SPHERE[dim] * np.sum(weights * values * r ** (dim - 1))


def gauss_nodes(R):
    """Nodes and weights on (0, R), exact for the polynomials of the kernel."""
    x, weights = np.polynomial.legendre.leggauss(12)
    return 0.5 * R * (x + 1), 0.5 * R * weights


@SUPPORT
def test_integral_is_one(point, dim, R):
    r, weights = gauss_nodes(R)
    W, _ = point("wendland_c2", r, 1 / R, dim=dim)
    assert radial_integral(W, r, weights, dim) == pytest.approx(1, abs=1e-12)


@SUPPORT
def test_first_moment_of_the_gradient_is_minus_the_identity(point, dim, R):
    r, weights = gauss_nodes(R)
    _, F = point("wendland_c2", r, 1 / R, dim=dim)
    assert radial_integral(F * r**2, r, weights, dim) == pytest.approx(-dim, abs=1e-12)


@SUPPORT
def test_gradient_factor_is_the_derivative_over_r(point, dim, R):
    """W is a polynomial of degree 5, so its Chebyshev interpolant has its exact derivative."""
    W = np.polynomial.Chebyshev.interpolate(
        lambda r: point("wendland_c2", r, 1 / R, dim=dim)[0], 5, domain=[0, R]
    )
    r = np.linspace(0.01, 0.99, 37) * R
    _, F = point("wendland_c2", r, 1 / R, dim=dim)
    np.testing.assert_allclose(F * r, W.deriv()(r), rtol=1e-9, atol=1e-12 * W(0) / R)


@SUPPORT
def test_vanishes_at_and_beyond_the_support(point, dim, R):
    W, F = point("wendland_c2", R * np.array([1.0, 1.0 + 1e-15, 1.5, 100.0]), 1 / R, dim=dim)
    assert (W == 0).all()
    assert (F == 0).all()


def test_is_positive_and_decreasing_inside(point, dim):
    W, F = point("wendland_c2", np.linspace(0, 0.999, 500), 1.0, dim=dim)
    assert (W > 0).all()
    assert (F < 0).all()
    assert (np.diff(W) < 0).all()


def test_is_regular_at_the_origin(point, dim):
    """F tends to W''(0) = -20 W(0)/R^2."""
    W, F = point("wendland_c2", [0.0, 1e-300], 0.5, dim=dim)
    np.testing.assert_allclose(F, -20 * W / 4, rtol=1e-15)


@pytest.mark.parametrize("name", ["c2", "c6"])
@pytest.mark.parametrize(("dp", "R"), [(1.0, 2.6), (0.01, 0.026), (0.02, 0.06)])
def test_lattice_sums_are_sums_over_a_lattice(point, dim, name, dp, R):
    x = dp * np.array(list(product(range(-4, 5), repeat=dim)))
    kernel = {"c2": "wendland_c2", "c6": "kernel"}[name]
    W, F = point(kernel, np.linalg.norm(x, axis=1), 1 / R, dim=dim)
    (concentration,), (moment,) = point(f"lattice_sums_{name}", dp, R, dim=dim)
    assert concentration == pytest.approx(dp**dim * W.sum(), rel=1e-13)
    assert moment == pytest.approx(-(dp**dim) * (F * x[:, -1] ** 2).sum(), rel=1e-13)


@pytest.mark.parametrize("name", ["c2", "c6"])
def test_lattice_sums_tend_to_one_on_fine_lattices(point, dim, name):
    error = [
        np.abs(point(f"lattice_sums_{name}", 1 / n, 1.0, dim=dim).ravel() - 1) for n in (3, 6, 12)
    ]
    assert (error[2] < 1e-3).all()
    assert (error[2] < error[0]).all()
