"""What pairs of fluid particles, and of fluid and wall, add in the resolved scheme."""

from __future__ import annotations

import numpy as np
import pytest

C, RHO = 30.0, 1000.0


def rows(values):
    """The columns of an array of vectors."""
    return list(np.asarray(values).reshape(len(values), -1).T)


def test_approach_pressure_is_that_of_the_limited_riemann_solver(point):
    """beta = 3 dU/c where a pair approaches, 1 where fast, 0.05 where it hardly does or recedes."""
    dU = C * np.array([-2, -0.1, 0, 0.01, 0.1, 0.2, 1 / 3, 0.5, 2])
    beta = np.array([0.05, 0.05, 0.05, 0.05, 0.3, 0.6, 1, 1, 1])
    (p,) = point("approach_pressure", dU, RHO, C, 0)
    np.testing.assert_allclose(p, 0.5 * beta * RHO * C * dU, rtol=1e-13)


def test_what_is_small_beside_a_resolved_flow_has_no_least_beta(point):
    """Half of it where the approach is twice what the strain makes of the distance."""
    rate, r = 5.0, 0.01
    (smooth,) = point("smooth_approach", rate, r)
    dU = -rate * r * np.array([2e-3, 0.2, 2, 20, 2e3])
    (p,) = point("approach_pressure", dU, RHO, C, smooth)
    share = np.array([1e-6, 1 / 101, 1 / 2, 100 / 101, 1 - 1e-6])
    np.testing.assert_allclose(p, 0.5 * 0.05 * share * RHO * C * dU, rtol=2e-6)


def test_what_approaches_fast_is_not_spared_by_a_resolved_flow(point):
    dU = C * np.array([0.1, 0.2, 0.5])
    (p,) = point("approach_pressure", dU, RHO, C, (0.5 * C) ** 2)
    np.testing.assert_allclose(p, 0.5 * np.minimum(3 * dU / C, 1) * RHO * C * dU, rtol=1e-13)


@pytest.mark.parametrize("smooth", [0.0, (0.01 * C) ** 2, C**2])
def test_approach_pressure_is_continuous_and_never_lowers_the_dissipation(point, smooth):
    dU = np.linspace(-C, C, 4001)
    (p,) = point("approach_pressure", dU, RHO, C, smooth)
    assert (p * dU >= 0).all()
    assert np.abs(np.diff(p)).max() < 2.1 * RHO * C * (dU[1] - dU[0])
    assert (np.diff(p) > 0).all()


def test_pressure_jump_of_a_quadratic_field_vanishes(point, dim, random):
    """The mean of both gradients gives the difference of a quadratic exactly."""
    x_i, x_j = random.normal(size=(2, 50, dim))
    A, b = random.normal(size=(dim, dim)), random.normal(size=dim)
    A = A + A.T

    def p(x):
        return 0.5 * np.einsum("na,ab,nb->n", x, A, x) + x @ b

    columns = [p(x_i), p(x_j), *rows(x_i @ A + b), *rows(x_j @ A + b), *rows(x_i - x_j)]
    (jump,) = point("pressure_jump", *columns, dim=dim)
    np.testing.assert_allclose(jump, 0, atol=1e-13)
    (jump,) = point(
        "pressure_jump", *columns[:2], *np.zeros((2 * dim, 50)), *columns[-dim:], dim=dim
    )
    np.testing.assert_allclose(jump, p(x_i) - p(x_j), rtol=1e-14)


def test_viscous_direction_of_morris_is_the_jump(point, dim, random):
    v, r = random.normal(size=(2, 50, dim))
    np.testing.assert_allclose(
        point("viscous_direction", 1, 0, 0, *rows(v), *rows(v), *rows(r), dim=dim),
        v.T,
        rtol=1e-15,
    )


def test_viscous_direction_of_monaghan_is_central(point, dim, random):
    """(D + 2) (v.n) n: along the line of the pair, so that it has no moment."""
    v, r = random.normal(size=(2, 50, dim))
    n = r / np.linalg.norm(r, axis=1)[:, None]
    expected = (dim + 2) * (v * n).sum(axis=1)[:, None] * n
    actual = point("viscous_direction", 0, 0, dim + 2, *rows(v), *rows(v), *rows(r), dim=dim)
    np.testing.assert_allclose(actual, expected.T, rtol=1e-12, atol=1e-14)


def test_viscous_direction_of_the_stress_is_that_of_the_strain(point, dim, random):
    """2 D r where velocity is linear; so nothing where it turns as a solid."""
    L, r = random.normal(size=(dim, dim)), random.normal(size=(50, dim))
    actual = point("viscous_direction", 1, 1, 0, *rows(r @ L.T), *rows(r @ L), *rows(r), dim=dim)
    np.testing.assert_allclose(actual, (r @ (L + L.T)).T, rtol=1e-11, atol=1e-13)


def test_viscous_forms_are_the_laplacian_of_a_shear_flow(point, dim):
    """v_x = y^2/2: the integral of 2 F v_ij over the kernel is 1, in the other forms as well."""
    R, n = 1.0, 61
    axis = np.linspace(-R, R, n)
    x = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    x = x[(np.linalg.norm(x, axis=1) < R) & (np.abs(x).max(axis=1) > 0)]
    _, F = point("wendland_c2", np.linalg.norm(x, axis=1), 1 / R, dim=dim)
    v_ij = np.zeros_like(x)
    v_ij[:, 0] = -0.5 * x[:, 1] ** 2
    transposed = np.zeros_like(x)  # of the mean velocity gradient, r_ij = -x
    transposed[:, 1] = -0.5 * x[:, 1] * x[:, 0]
    for form in ((1, 0, 0), (0, 0, dim + 2), (1, 1, 0)):
        direction = point(
            "viscous_direction", *form, *rows(v_ij), *rows(transposed), *rows(-x), dim=dim
        )
        total = 2 * (F * direction).sum(axis=1) * (axis[1] - axis[0]) ** dim
        np.testing.assert_allclose(total, np.eye(dim)[0], atol=5e-3)


def test_no_slip_factor_extrapolates_to_the_far_side_of_the_surface(point):
    """Velocity linear in the distance d_i: at depth d_w it is -v d_w/d_i."""
    d_w, d_i = np.array([0.5, 1.5, 2.5, 1.0]), np.array([0.5, 0.5, 1.0, 2.0])
    (factor,) = point("no_slip_factor", d_w, d_i, 0.25)
    np.testing.assert_allclose(factor, 1 + d_w / d_i, rtol=1e-15)
    (factor,) = point("no_slip_factor", 1.0, [0.2, 0.0, -3.0], 0.25)
    np.testing.assert_allclose(factor, 5, rtol=1e-15)


def test_shear_counts_where_viscosity_resolves_it(point):
    """Half of it at ten for the Reynolds number of a spacing; all in a liquid at rest."""
    speed = np.array([0.0, 0.01, 1.0, 100.0])
    (share,) = point("resolved_shear", 1.0, RHO, speed, 0.01)
    np.testing.assert_allclose(share, [1, 1 / 1.01, 0.5, 1 / 101], rtol=1e-12)
    assert point("resolved_shear", 0.0, RHO, 0.0, 0.01)[0] == 0.0


def test_normal_at_the_foot_is_that_of_a_ball(point, dim, random):
    """Where it leans by less than 0.3; farther round it leans by that and no more."""
    normal, along = random.normal(size=(2, 50, dim))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    along -= (along * normal).sum(axis=1)[:, None] * normal
    along /= np.linalg.norm(along, axis=1)[:, None]
    lean = random.uniform(0, 0.6, (50, 1))
    foot = np.array(point("normal_at_foot", *rows(normal), *rows(lean * along), dim=dim)).T
    exact = normal + np.minimum(lean, 0.3) * along
    np.testing.assert_allclose(foot, exact / np.linalg.norm(exact, axis=1)[:, None], atol=1e-14)


def test_an_edge_counts_and_the_noise_of_a_face_does_not(point):
    """Odd in the rate, nothing below 0.15 of the size, all of it from 0.3 on."""
    rate = np.array([0.0, 0.14, 0.2, 0.3, 0.6])
    (taken,) = point("edge_rate", rate, 1.0)
    np.testing.assert_allclose(taken, [0, 0, 0.2 / 3, 0.3, 0.6], rtol=1e-12)
    (opposite,) = point("edge_rate", -3 * rate, 3.0)
    np.testing.assert_allclose(opposite, -3 * taken, rtol=1e-12)
    assert point("edge_rate", 0.0, 0.0)[0] == 0.0


def test_wall_excess_pressure_is_hydrostatic_across_a_wall(point, dim, random):
    """Where gravity presses water onto the wall and the fluid is level along it."""
    normal, r = random.normal(size=(2, 40, dim))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    g_n, r_n = random.uniform(-10, 10, 40), (r * normal).sum(axis=1)
    gradient = -3.0 * normal  # across the wall: must not count
    inputs = RHO, g_n, r_n, *rows(gradient), *rows(normal), *rows(r)
    (deep,) = point("wall_excess_pressure", 1e6, *inputs, dim=dim)
    np.testing.assert_allclose(deep, RHO * g_n * r_n, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("p", [0.0, 300.0, -300.0])
def test_no_wall_holds_water_up(point, p):
    """Under a ceiling the pressure of the wall falls to zero, not below."""
    gradient, normal, r = np.zeros(2), np.array([0.0, -1.0]), np.array([0.0, -0.1])
    below, above = (
        point("wall_excess_pressure", p, RHO, g_n, 0.1, *gradient, *normal, *r, dim=2)[0, 0]
        for g_n in (-9.8, 9.8)
    )
    assert p + below == pytest.approx(min(p, 0) if p < 980 else p - 980, abs=1e-9)
    assert above == pytest.approx(980)


def test_wall_excess_pressure_follows_the_fluid_along_a_wall(point, dim, random):
    """Beside a vertical wall p_w - p_i = rho g (z_i - z_w), with no part of gravity across it."""
    normal = np.zeros((40, dim))
    normal[:, 0] = 1.0
    gradient = np.zeros((40, dim))
    gradient[:, -1] = -RHO * 9.8
    r = random.normal(size=(40, dim))
    (p,) = point(
        "wall_excess_pressure",
        *(0.0, RHO, 0.0, r[:, 0]),
        *(*rows(gradient), *rows(normal), *rows(r)),
        dim=dim,
    )
    np.testing.assert_allclose(p, RHO * 9.8 * r[:, -1], rtol=1e-12)


@pytest.mark.parametrize("ks", [1e-3, 0.02])
def test_bed_friction_inverts_the_logarithmic_law(point, ks):
    """u(z) = u*/0.4 ln(1 + 30 z/ks), tau = rho u*^2."""
    z, u_star = ks * np.geomspace(1 / 30, 1000, 40), 0.13
    u = u_star / 0.4 * np.log(1 + 30 * z / ks)
    (friction,) = point("bed_friction", RHO, z, ks)
    np.testing.assert_allclose(friction * u**2, RHO * u_star**2, rtol=1e-13)


def test_bed_friction_is_bounded_below_the_roughness(point):
    (friction,) = point("bed_friction", RHO, [0.02 / 30, 1e-5, 0.0, -1.0], 0.02)
    np.testing.assert_allclose(friction, RHO * (0.4 / np.log(2)) ** 2, rtol=1e-13)


def test_voellmy_s_stress(point):
    """mu sigma' + rho g u^2/xi; what does not press has no friction of Coulomb's."""
    (stress,) = point("voellmy_stress", 0.2, [3e3, -1.0], 2000.0, 9.81, 5.0, 250.0)
    turbulent = 2000 * 9.81 * 25 / 250
    np.testing.assert_allclose(stress, [600 + turbulent, turbulent], rtol=1e-14)
    assert point("voellmy_stress", 0.2, 3e3, 2000.0, 9.81, 5.0, np.inf)[0] == 600
