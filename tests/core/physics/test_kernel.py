"""The kernels by calculus: integral, gradient, support, and what lattices make of them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest

SUPPORT = pytest.mark.parametrize("R", [1.0, 0.03, 7.5])
SPHERE = {2: 2 * np.pi, 3: 4 * np.pi}  # area of the unit sphere


@dataclass(frozen=True)
class Kernel:
    """A kernel, a polynomial of `degree`, as the core names it; W''(0) = -curvature W(0)/R^2."""

    function: str
    lattice_sums: str
    degree: int
    nodes: int
    curvature: float
    slope_error: float  # of its Chebyshev interpolant, over W(0)/R


C2 = Kernel("wendland_c2", "lattice_sums_c2", 5, 12, 20, 1e-12)
C6 = Kernel("kernel", "lattice_sums_c6", 11, 20, 22, 1e-11)


@pytest.fixture(params=[C2, C6], ids=["c2", "c6"])
def kernel(request):
    return request.param


def radial_integral(values, r, weights, dim):
    """Integral over space of a function of r, given at the nodes of a quadrature."""
    return SPHERE[dim] * np.sum(weights * values * r ** (dim - 1))


def gauss_nodes(R, count):
    """Nodes and weights on (0, R), exact for the polynomials of the kernel."""
    x, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * R * (x + 1), 0.5 * R * weights


@SUPPORT
def test_integral_is_one(point, kernel, dim, R):
    r, weights = gauss_nodes(R, kernel.nodes)
    W, _ = point(kernel.function, r, 1 / R, dim=dim)
    assert radial_integral(W, r, weights, dim) == pytest.approx(1, abs=1e-12)


@SUPPORT
def test_first_moment_of_the_gradient_is_minus_the_identity(point, kernel, dim, R):
    """The integral of r . grad W is -dim: linear fields have the right gradient."""
    r, weights = gauss_nodes(R, kernel.nodes)
    _, F = point(kernel.function, r, 1 / R, dim=dim)
    assert radial_integral(F * r**2, r, weights, dim) == pytest.approx(-dim, abs=1e-12)


@SUPPORT
def test_gradient_factor_is_the_derivative_over_r(point, kernel, dim, R):
    """The Chebyshev interpolant of a polynomial has its exact derivative."""
    W = np.polynomial.Chebyshev.interpolate(
        lambda r: point(kernel.function, r, 1 / R, dim=dim)[0], kernel.degree, domain=[0, R]
    )
    r = np.linspace(0.01, 0.99, 37) * R
    _, F = point(kernel.function, r, 1 / R, dim=dim)
    atol = kernel.slope_error * W(0) / R
    np.testing.assert_allclose(F * r, W.deriv()(r), rtol=1e-9, atol=atol)


@SUPPORT
def test_vanishes_at_and_beyond_the_support(point, kernel, dim, R):
    r = R * np.array([1.0, 1.0 + 1e-15, 1.5, 100.0])
    W, F = point(kernel.function, r, 1 / R, dim=dim)
    assert (W == 0).all()
    assert (F == 0).all()


@SUPPORT
def test_is_positive_and_decreasing_inside(point, kernel, dim, R):
    W, F = point(kernel.function, np.linspace(0, 0.999, 500) * R, 1 / R, dim=dim)
    assert (W > 0).all()
    assert (F < 0).all()
    assert (np.diff(W) < 0).all()


def test_is_regular_at_the_origin(point, kernel, dim):
    """F tends to W''(0): no singularity to guard."""
    W, F = point(kernel.function, [0.0, 1e-300], 0.5, dim=dim)
    np.testing.assert_allclose(F, -kernel.curvature * W / 4, rtol=1e-15)


def test_the_paper_s_kernel_sums_to_one_on_the_standard_lattice(point, dim):
    """With h = 1.2 spacings the sum over a lattice is 1.0032 (2-D) and 1.0035 (3-D)."""
    axis = np.arange(-3, 4)
    r = np.sqrt(sum(x**2 for x in np.meshgrid(*[axis] * dim))).ravel()
    W, _ = point(C6.function, r, 1 / (2.5 * 1.2), dim=dim)
    assert W.sum() == pytest.approx({2: 1.0032, 3: 1.0035}[dim], abs=5e-5)


@pytest.mark.parametrize(("dp", "R"), [(1.0, 2.6), (0.01, 0.026), (0.02, 0.06)])
def test_lattice_sums_are_sums_over_a_lattice(point, kernel, dim, dp, R):
    x = dp * np.array(list(product(range(-4, 5), repeat=dim)))
    W, F = point(kernel.function, np.linalg.norm(x, axis=1), 1 / R, dim=dim)
    (concentration,), (moment,) = point(kernel.lattice_sums, dp, R, dim=dim)
    assert concentration == pytest.approx(dp**dim * W.sum(), rel=1e-13)
    assert moment == pytest.approx(-(dp**dim) * (F * x[:, -1] ** 2).sum(), rel=1e-13)


def test_lattice_sums_tend_to_one_on_fine_lattices(point, kernel, dim):
    error = [
        np.abs(point(kernel.lattice_sums, 1 / n, 1.0, dim=dim).ravel() - 1) for n in (3, 6, 12)
    ]
    assert (error[2] < 1e-3).all()
    assert (error[2] < error[0]).all()
