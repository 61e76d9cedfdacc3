"""The Wendland C6 kernel by calculus: integral, gradient, support."""

from __future__ import annotations

import numpy as np
import pytest

SUPPORT = pytest.mark.parametrize("R", [1.0, 0.03, 7.5])
SPHERE = {2: 2 * np.pi, 3: 4 * np.pi}  # area of the unit sphere


def radial_integral(values, r, weights, dim):
    """Integral over space of a function of r, given at the nodes of a quadrature."""
    return SPHERE[dim] * np.sum(weights * values * r ** (dim - 1))


def gauss_nodes(R):
    """Nodes and weights on (0, R), exact for the polynomials of the kernel."""
    x, weights = np.polynomial.legendre.leggauss(20)
    return 0.5 * R * (x + 1), 0.5 * R * weights


@SUPPORT
def test_integral_is_one(point, dim, R):
    r, weights = gauss_nodes(R)
    W, _ = point("kernel", r, 1 / R, dim=dim)
    assert radial_integral(W, r, weights, dim) == pytest.approx(1, abs=1e-12)


@SUPPORT
def test_first_moment_of_the_gradient_is_minus_the_identity(point, dim, R):
    """The integral of r . grad W is -dim: linear fields have the right gradient."""
    r, weights = gauss_nodes(R)
    _, F = point("kernel", r, 1 / R, dim=dim)
    assert radial_integral(F * r**2, r, weights, dim) == pytest.approx(-dim, abs=1e-12)


@SUPPORT
def test_gradient_factor_is_the_derivative_over_r(point, dim, R):
    """W is a polynomial of degree 11, so its Chebyshev interpolant has its exact derivative."""
    W = np.polynomial.Chebyshev.interpolate(
        lambda r: point("kernel", r, 1 / R, dim=dim)[0], 11, domain=[0, R]
    )
    r = np.linspace(0.01, 0.99, 37) * R
    _, F = point("kernel", r, 1 / R, dim=dim)
    np.testing.assert_allclose(F * r, W.deriv()(r), rtol=1e-9, atol=1e-11 * W(0) / R)


@SUPPORT
def test_vanishes_at_and_beyond_the_support(point, dim, R):
    W, F = point("kernel", R * np.array([1.0, 1.0 + 1e-15, 1.5, 100.0]), 1 / R, dim=dim)
    assert (W == 0).all()
    assert (F == 0).all()


@SUPPORT
def test_is_positive_and_decreasing_inside(point, dim, R):
    r = np.linspace(0, 0.999, 500) * R
    W, F = point("kernel", r, 1 / R, dim=dim)
    assert (W > 0).all()
    assert (F < 0).all()
    assert (np.diff(W) < 0).all()


def test_is_regular_at_the_origin(point, dim):
    """F tends to W''(0) = -22 W(0)/R^2: no singularity to guard."""
    W, F = point("kernel", [0.0, 1e-300], 0.5, dim=dim)
    np.testing.assert_allclose(F, -22 * W / 4, rtol=1e-15)


def test_sums_to_one_on_the_standard_lattice(point, dim):
    """With h = 1.2 spacings the sum over a lattice is 1.0032 (2-D) and 1.0035 (3-D)."""
    axis = np.arange(-3, 4)
    r = np.sqrt(sum(x**2 for x in np.meshgrid(*[axis] * dim))).ravel()
    W, _ = point("kernel", r, 1 / (2.5 * 1.2), dim=dim)
    assert W.sum() == pytest.approx({2: 1.0032, 3: 1.0035}[dim], abs=5e-5)
