"""Laws of elastic solids against tensor algebra and against their own energies."""

from __future__ import annotations

import numpy as np
import pytest

N = 11  # of random samples: more than a pack, and no multiple of one
LAMBDA, MU = 3.0, 2.0
LAWS = ["st_venant_kirchhoff", "neo_hookean"]
STORED = {
    2: ((0, 0), (1, 1), (0, 1)),
    3: ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)),
}


def columns(tensor):
    """The columns of (n, dim, dim) matrices, row by row."""
    return tensor.reshape(len(tensor), -1).T


def matrices(columns, dim):
    """The (n, dim, dim) matrices of columns."""
    return columns[: dim * dim].T.reshape(-1, dim, dim)


def symmetric(columns, dim):
    """The (n, dim, dim) matrices of the stored parts of symmetric ones."""
    result = np.zeros((columns.shape[1], dim, dim))
    for column, (a, b) in zip(columns, STORED[dim], strict=True):
        result[:, a, b] = result[:, b, a] = column
    return result


def random_deformation(random, dim):
    """(N, dim, dim) deformation gradients with positive determinants."""
    return np.eye(dim) + 0.2 * random.uniform(-1, 1, (N, dim, dim))


def rotations(random, dim):
    """(N, dim, dim) rotations."""
    Q, _ = np.linalg.qr(random.normal(size=(N, dim, dim)))
    Q[:, :, 0] *= np.linalg.det(Q)[:, None]
    return Q


def stress(point, law, F, dim):
    """P and the energy of deformation gradients."""
    out = point(law, *columns(F), LAMBDA, MU, dim=dim)
    return matrices(out, dim), out[dim * dim]


def test_green_strain(point, dim, random):
    F = random_deformation(random, dim)
    E = symmetric(point("green_strain", *columns(F), dim=dim), dim)
    np.testing.assert_allclose(E, 0.5 * (F.transpose(0, 2, 1) @ F - np.eye(dim)), atol=1e-15)


def test_st_venant_kirchhoff_is_its_definition(point, dim, random):
    F = random_deformation(random, dim)
    E = 0.5 * (F.transpose(0, 2, 1) @ F - np.eye(dim))
    trace = np.trace(E, axis1=1, axis2=2)
    P, energy = stress(point, "st_venant_kirchhoff", F, dim)
    S = LAMBDA * trace[:, None, None] * np.eye(dim) + 2 * MU * E
    np.testing.assert_allclose(P, F @ S, atol=1e-13)
    np.testing.assert_allclose(energy, LAMBDA / 2 * trace**2 + MU * (E**2).sum((1, 2)), rtol=1e-13)


def test_neo_hookean_is_its_definition(point, dim, random):
    F = random_deformation(random, dim)
    inverse = np.linalg.inv(F).transpose(0, 2, 1)
    log_J = np.log(np.linalg.det(F))
    P, energy = stress(point, "neo_hookean", F, dim)
    np.testing.assert_allclose(
        P, MU * (F - inverse) + LAMBDA * log_J[:, None, None] * inverse, atol=1e-13
    )
    expected = MU / 2 * ((F**2).sum((1, 2)) - dim) - MU * log_J + LAMBDA / 2 * log_J**2
    np.testing.assert_allclose(energy, expected, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("law", LAWS)
def test_stress_is_the_slope_of_the_energy(point, law, dim, random):
    F, step = random_deformation(random, dim), 1e-5
    P, _ = stress(point, law, F, dim)
    for a in range(dim):
        for b in range(dim):
            change = np.zeros((dim, dim))
            change[a, b] = step
            _, above = stress(point, law, F + change, dim)
            _, below = stress(point, law, F - change, dim)
            np.testing.assert_allclose(P[:, a, b], (above - below) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("law", LAWS)
def test_rotation_makes_no_stress_and_turns_what_there_is(point, law, dim, random):
    Q, F = rotations(random, dim), random_deformation(random, dim)
    np.testing.assert_allclose(stress(point, law, Q, dim)[0], 0, atol=1e-13)
    P, energy = stress(point, law, F, dim)
    turned, same = stress(point, law, Q @ F, dim)
    np.testing.assert_allclose(turned, Q @ P, atol=1e-12)
    np.testing.assert_allclose(same, energy, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("law", LAWS)
def test_small_strains_are_hooke_s(point, law, dim, random):
    small = 1e-6 * random.normal(size=(N, dim, dim))
    strain = 0.5 * (small + small.transpose(0, 2, 1))
    trace = np.trace(strain, axis1=1, axis2=2)[:, None, None]
    P, _ = stress(point, law, np.eye(dim) + small, dim)
    np.testing.assert_allclose(P, LAMBDA * trace * np.eye(dim) + 2 * MU * strain, atol=1e-10)


def test_damping_resists_strain_and_not_rotation(point, dim, random):
    F, rate, eta = random_deformation(random, dim), random.normal(size=(N, dim, dim)), 0.7
    P = matrices(point("kelvin_voigt", *columns(F), *columns(rate), eta, dim=dim), dim)
    E_rate = 0.5 * (F.transpose(0, 2, 1) @ rate + rate.transpose(0, 2, 1) @ F)
    np.testing.assert_allclose(P, F @ (2 * eta * E_rate), atol=1e-12)
    np.testing.assert_allclose(
        (P * rate).sum((1, 2)), 2 * eta * (E_rate**2).sum((1, 2)), rtol=1e-10
    )
    spin = rate - rate.transpose(0, 2, 1)
    none = point("kelvin_voigt", *columns(F), *columns(spin @ F), eta, dim=dim)
    np.testing.assert_allclose(none, 0, atol=1e-12)


def test_cauchy_stress(point, dim, random):
    F, P = random_deformation(random, dim), random.normal(size=(N, dim, dim))
    sigma = P @ F.transpose(0, 2, 1) / np.linalg.det(F)[:, None, None]
    got = symmetric(point("cauchy_stress", *columns(P), *columns(F), dim=dim), dim)
    np.testing.assert_allclose(got, 0.5 * (sigma + sigma.transpose(0, 2, 1)), atol=1e-13)


def test_springs_see_only_what_the_deformation_misses(point, dim, random):
    """Where r_ij = F R_ij they add nothing; otherwise kappa times what is missing, twice."""
    F, R = random_deformation(random, dim), random.normal(size=(N, dim))
    P_i, P_j = random.normal(size=(2, N, dim, dim))
    missing, kappa = random.normal(size=(N, dim)), 5.0
    r = np.einsum("nab,nb->na", F, R)
    stress = [*columns(P_i), *columns(P_j), *columns(F), *columns(F), kappa]
    expected = np.einsum("nab,nb->na", P_i + P_j, R)
    affine = point("elastic_pair_force", *stress, *R.T, *r.T, dim=dim)
    np.testing.assert_allclose(affine.T, expected, atol=1e-12)
    other = point("elastic_pair_force", *stress, *R.T, *(r + missing).T, dim=dim)
    np.testing.assert_allclose(other.T, expected + 2 * kappa * missing, atol=1e-12)
