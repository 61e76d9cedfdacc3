"""Elastic and viscous stress against tensor algebra in three dimensions."""

from __future__ import annotations

import numpy as np
import pytest

# How the core stores a traceless tensor: S_zz = -(S_xx + S_yy) is implied.
STORED = {2: ((0, 0), (1, 1), (0, 1)), 3: ((0, 0), (1, 1), (0, 1), (0, 2), (1, 2))}
SYMMETRIC = {
    2: ((0, 0), (1, 1), (0, 1)),
    3: ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)),
}
N = 11  # of random samples: more than a pack, and no multiple of one


def stored(S, dim):
    """The columns in which a (..., 3, 3) deviator goes to the core."""
    return [S[..., a, b] for a, b in STORED[dim]]


def full(columns, dim):
    """The (n, 3, 3) deviator that columns of the core stand for."""
    S = np.zeros((columns.shape[1], 3, 3))
    for column, (a, b) in zip(columns, STORED[dim], strict=True):
        S[:, a, b] = S[:, b, a] = column
    S[:, 2, 2] = -(S[:, 0, 0] + S[:, 1, 1])
    return S


def gradient_columns(L, dim):
    """The columns of a (..., 3, 3) velocity gradient, row by row."""
    return [L[..., a, b] for a in range(dim) for b in range(dim)]


def elastic_rate(point, L, S, mu, dim):
    """dS/dt of (n, 3, 3) tensors."""
    columns = point("elastic_stress_rate", *gradient_columns(L, dim), *stored(S, dim), mu, dim=dim)
    return full(columns, dim)


def random_gradient(random, dim):
    """(N, 3, 3) velocity gradients; in plane strain nothing happens along z."""
    L = np.zeros((N, 3, 3))
    L[:, :dim, :dim] = random.normal(size=(N, dim, dim))
    return L


def random_deviator(random, dim):
    """(N, 3, 3) symmetric traceless tensors; plane strain has no xz and yz."""
    S = random.normal(size=(N, 3, 3))
    S = S + S.transpose(0, 2, 1)
    if dim == 2:
        S[:, 2, :2] = S[:, :2, 2] = 0
    S[:, 2, 2] = -(S[:, 0, 0] + S[:, 1, 1])
    return S


def deviatoric_strain_rate(L):
    """D - tr(D)/3 E."""
    D = 0.5 * (L + L.transpose(0, 2, 1))
    return D - np.trace(L, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)


def test_elastic_rate_is_equation_4(point, dim, random):
    L, S, mu = random_gradient(random, dim), random_deviator(random, dim), 7.0
    spin = 0.5 * (L - L.transpose(0, 2, 1))
    expected = 2 * mu * deviatoric_strain_rate(L) + spin @ S - S @ spin
    np.testing.assert_allclose(elastic_rate(point, L, S, mu, dim), expected, rtol=0, atol=1e-12)


def test_pure_shear(point, dim):
    L = np.zeros((1, 3, 3))
    L[0, 0, 1] = 3.0
    rate = elastic_rate(point, L, np.zeros((1, 3, 3)), 5.0, dim)[0]
    expected = np.zeros((3, 3))
    expected[0, 1] = expected[1, 0] = 15.0
    np.testing.assert_allclose(rate, expected)


def test_uniaxial_compression(point, dim):
    """Also in 2-D S_zz takes its third: plane strain."""
    L = np.zeros((1, 3, 3))
    L[0, 0, 0] = -3.0
    rate = elastic_rate(point, L, np.zeros((1, 3, 3)), 5.0, dim)[0]
    np.testing.assert_allclose(rate, np.diag([-20.0, 10.0, 10.0]))


def test_equal_compression_of_all_axes_in_the_run(point, dim):
    """No deviatoric stress in 3-D; in 2-D the third axis does not follow."""
    L = np.zeros((1, 3, 3))
    L[0, :dim, :dim] = -3.0 * np.eye(dim)
    rate = elastic_rate(point, L, np.zeros((1, 3, 3)), 5.0, dim)[0]
    expected = np.diag([-10.0, -10.0, 20.0]) if dim == 2 else np.zeros((3, 3))
    np.testing.assert_allclose(rate, expected, atol=1e-14)


def rotated_by_steps(point, S, spin, angle, steps, dim):
    """S after a rigid rotation, integrated with the predictor of the scheme's second order."""
    step = angle / steps
    for _ in range(steps):
        first = elastic_rate(point, spin, S, 1e9, dim)
        second = elastic_rate(point, spin, S + step * first, 1e9, dim)
        S = S + 0.5 * step * (first + second)
    return S


def plane_rotation(angle, a, b):
    """Rotation matrix from axis a towards axis b."""
    R = np.eye(3)
    R[a, a] = R[b, b] = np.cos(angle)
    R[b, a], R[a, b] = np.sin(angle), -np.sin(angle)
    return R


@pytest.mark.parametrize(
    ("dim", "a", "b"), [(2, 0, 1), (3, 0, 1), (3, 1, 2), (3, 2, 0)], ids=["2d", "z", "x", "y"]
)
def test_rigid_rotation_turns_the_stress(point, dim, a, b):
    """S = diag(1, -1) turned by 45 degrees is S_xy = +1; the error falls as the square of dt."""
    S = np.zeros((1, 3, 3))
    S[0, a, a], S[0, b, b] = 1.0, -1.0
    spin = np.zeros((1, 3, 3))
    spin[0, b, a], spin[0, a, b] = 1.0, -1.0  # d v_b/d x_a = +1: turns a towards b
    R = plane_rotation(np.pi / 4, a, b)
    coarse, fine = (rotated_by_steps(point, S, spin, np.pi / 4, n, dim)[0] for n in (25, 50))
    assert fine[a, b] == pytest.approx(1, abs=1e-3)
    errors = [np.linalg.norm(result - R @ S[0] @ R.T) for result in (coarse, fine)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    norms = [abs(np.linalg.norm(result) - np.sqrt(2)) for result in (coarse, fine)]
    assert norms[1] < 1e-5
    assert norms[0] / norms[1] > 3.9


def test_spin_does_no_work_on_the_stress(point, dim, random):
    """S : (dS/dt) vanishes in rigid rotation, whatever S."""
    L, S = random_gradient(random, dim), random_deviator(random, dim)
    spin = L - L.transpose(0, 2, 1)
    rate = elastic_rate(point, spin, S, 1e3, dim)
    np.testing.assert_allclose(np.sum(S * rate, axis=(1, 2)), 0, atol=1e-12)


def test_newtonian_stress_is_equation_7(point, dim, random):
    L, rho, nu = random_gradient(random, dim), 1010.0, 1e-3
    mu = point("newtonian", 1.0, 0.0, rho, nu)[0]
    tau = point("viscous_stress", *gradient_columns(L, dim), mu, dim=dim)
    expected = 2 * rho * nu * deviatoric_strain_rate(L)
    np.testing.assert_allclose(full(tau, dim), expected, atol=1e-14)


def test_stress_over_rho_squared_is_equations_3_and_6(point, dim, random):
    S, p, rho = random_deviator(random, dim), random.normal(size=N), random.uniform(1, 2, N)
    columns = point("stress_over_rho_squared", *stored(S, dim), p, rho, dim=dim)
    sigma = S - p[:, None, None] * np.eye(3)
    for column, (a, b) in zip(columns, SYMMETRIC[dim], strict=True):
        np.testing.assert_allclose(column, sigma[:, a, b] / rho**2, atol=1e-14)


def test_shear_energy_counts_all_nine_components(point, dim, random):
    S, mu, rho = random_deviator(random, dim), 3.0, 2.0
    energy = point("shear_energy", *stored(S, dim), mu, rho, dim=dim)[0]
    np.testing.assert_allclose(energy, np.sum(S**2, axis=(1, 2)) / (4 * mu * rho), rtol=1e-14)


def test_shear_energy_is_the_work_of_the_stress(point, dim, random):
    """At constant density d(S:S/(4 mu rho))/dt = S:D/rho."""
    L, S, mu, rho, dt = random_gradient(random, dim), random_deviator(random, dim), 3.0, 2.0, 1e-4
    rate = elastic_rate(point, L, S, mu, dim)
    after, before = (
        point("shear_energy", *stored(S + sign * dt * rate, dim), mu, rho, dim=dim)[0]
        for sign in (1, -1)
    )
    power = np.sum(S * deviatoric_strain_rate(L), axis=(1, 2)) / rho
    np.testing.assert_allclose((after - before) / (2 * dt), power, atol=1e-10)
