"""Viscosities that depend on the rate of strain, against their closed forms."""

from __future__ import annotations

import numpy as np
import pytest

RATES = np.array([0.0, 1e-12, 1e-5, 1e-3, 0.1, 1.0, 30.0, 1e4])
LOTS = 1e12  # Pa s: no limit


RHO = 1000.0  # kg/m3


def slurry(point, rate, *parameters):
    """Viscosity of Herschel and Bulkley's law, which no pressure changes."""
    return point("herschel_bulkley", rate, 0.0, RHO, *parameters)[0]


def test_newton_s_law_has_the_viscosity_rho_nu(point):
    np.testing.assert_allclose(point("newtonian", RATES, 5.0, RHO, 2e-3)[0], 2.0, rtol=1e-15)


def test_newton_and_power_law(point):
    rate = RATES[2:]
    newton = slurry(point, rate, 0.0, 3.0, 1.0, 1.0, LOTS)
    np.testing.assert_allclose(newton, 3, rtol=1e-14)
    for n in (0.4, 1.5):
        stress = rate * slurry(point, rate, 0.0, 3.0, n, 1.0, LOTS)
        np.testing.assert_allclose(stress, 3 * rate**n, rtol=1e-12)


def test_bingham_stress(point):
    """tau = tau_y (1 - exp(-m rate)) + K rate: tau_y + K rate for m rate >> 1."""
    rate = RATES[2:]
    stress = rate * slurry(point, rate, 20.0, 3.0, 1.0, 100.0, LOTS)
    np.testing.assert_allclose(stress, -20 * np.expm1(-100 * rate) + 3 * rate, rtol=1e-6)
    np.testing.assert_allclose(stress[-3:], 20 + 3 * rate[-3:], rtol=1e-12)


@pytest.mark.parametrize("n", [0.5, 1.0, 2.0])
def test_viscosity_at_rest_is_finite_and_limited(point, n):
    eta = slurry(point, RATES, 20.0, 3.0, n, 100.0, 1500.0)
    assert np.all((eta > 0) & (eta <= 1500))
    at_rest = {0.5: 1500.0, 1.0: 1500.0, 2.0: 1500.0}[n]
    assert eta[0] == at_rest
    assert slurry(point, 0.0, 20.0, 3.0, 1.0, 100.0, LOTS)[0] == pytest.approx(2003)


def casson_stress(point, rate, *parameters):
    """Stress of Casson's law, which no pressure changes."""
    return rate * point("casson", rate, 0.0, RHO, *parameters)[0]


def test_roots_of_casson_s_stresses_add(point):
    """sqrt(tau) = sqrt(tau_y) (1 - exp(-sqrt(m rate))) + sqrt(eta rate)."""
    rate = RATES[2:]
    root = np.sqrt(casson_stress(point, rate, 20.0, 3.0, 100.0, LOTS))
    smooth = -np.sqrt(20) * np.expm1(-np.sqrt(100 * rate))
    np.testing.assert_allclose(root, smooth + np.sqrt(3 * rate), rtol=1e-9)
    np.testing.assert_allclose(root[-2:], np.sqrt(20) + np.sqrt(3 * rate[-2:]), rtol=1e-12)


def test_casson_s_liquid_is_newtonian_without_a_yield_stress_and_at_large_rates(point):
    rate = RATES[2:]
    np.testing.assert_allclose(
        casson_stress(point, rate, 0.0, 3.0, 9.0, LOTS), 3 * rate, rtol=1e-14
    )
    stress = casson_stress(point, 1e12, 20.0, 3.0, 100.0, LOTS)[0]
    assert stress == pytest.approx(3e12, rel=1e-5)


def test_casson_s_yield_stress_is_what_is_left_at_small_rates(point):
    """The law without its regularisation, m -> infinity."""
    rate = np.array([1e-9, 1e-6])
    stress = casson_stress(point, rate, 20.0, 3.0, 1e15, 1e15)
    np.testing.assert_allclose(stress, (np.sqrt(20) + np.sqrt(3 * rate)) ** 2, rtol=1e-12)
    assert stress[0] == pytest.approx(20, rel=3e-5)


def test_casson_s_stress_grows_with_the_rate(point):
    rate = np.geomspace(1e-9, 1e6, 400)
    for limit in (1500.0, LOTS):
        stress = casson_stress(point, rate, 20.0, 3.0, 100.0, limit)
        assert np.all(np.diff(stress) > 0)


def test_casson_s_viscosity_at_rest(point):
    at_rest = (np.sqrt(20 * 100) + np.sqrt(3)) ** 2
    assert point("casson", 0.0, 0.0, RHO, 20.0, 3.0, 100.0, LOTS)[0] == pytest.approx(at_rest)
    assert point("casson", 0.0, 0.0, RHO, 20.0, 3.0, 100.0, 1500.0)[0] == 1500


BEADS = (0.382, 0.643, 0.279, 5e-4, 2500.0)  # mu_s, mu_2, I_0, d, rho_s


def beads(point, rate, p, limit, pore=0.0):
    """Viscosity of glass beads, which the density of their mixture does not change."""
    return point("mu_i", rate, p, RHO, *BEADS, limit, pore)[0]


def mu_of(inertial):
    """mu(I) of glass beads."""
    return BEADS[0] + (BEADS[1] - BEADS[0]) / (BEADS[2] / inertial + 1)


@pytest.mark.parametrize("p", [3.0, 200.0])
def test_friction_is_mu_of_i(point, p):
    rate = RATES[3:]
    friction = rate * beads(point, rate, p, LOTS) / p
    np.testing.assert_allclose(friction, mu_of(rate * 5e-4 / np.sqrt(p / 2500)), rtol=1e-12)
    assert friction[0] == pytest.approx(0.382, abs=1e-3)
    assert beads(point, 1e9, p, LOTS)[0] * 1e9 / p == pytest.approx(0.643, rel=1e-3)


def test_without_pressure_there_is_no_friction(point):
    assert not beads(point, RATES, -5.0, LOTS).any()
    assert not beads(point, RATES, 0.0, LOTS).any()


@pytest.mark.parametrize("pore", [0.0, 0.3, 0.9])
def test_beads_feel_the_effective_pressure(point, pore):
    """(1 - lambda) p in place of p, to the last bit where there is no pore pressure."""
    wet, dry = beads(point, RATES, 200.0, 40.0, pore), beads(point, RATES, (1 - pore) * 200.0, 40.0)
    np.testing.assert_array_equal(wet, dry)
    assert beads(point, 1.0, 200.0, LOTS, 0.9)[0] < 0.2 * beads(point, 1.0, 200.0, LOTS)[0]


def test_friction_at_rest_is_limited(point):
    assert beads(point, 0.0, 200.0, 40.0)[0] == 40


def sheared(rate, dim, angle=0.0):
    """Velocity gradients of simple shear, the components as `point` takes them."""
    turn = np.eye(dim)
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    shear = np.zeros((dim, dim))
    shear[0, 1] = 1
    gradient = np.asarray(rate)[:, None, None] * (turn @ shear @ turn.T)
    return list(gradient.reshape(len(gradient), -1).T)


def test_mean_viscosities_of_a_pair(point, dim):
    some = sheared(np.ones(4), dim)
    mu_i, mu_j = np.array([1.0, 3.0, 0.0, 1e6]), np.array([3.0, 1, 0, 1])
    mean, by_rate, harmonic = point("pair_viscosity", mu_i, mu_j, *some, *some, dim=dim)
    np.testing.assert_allclose(mean, [2, 2, 0, 500000.5])
    np.testing.assert_allclose(by_rate, mean, rtol=1e-14)
    np.testing.assert_allclose(harmonic, [1.5, 1.5, 0, 2e6 / 1000001], atol=1e-20)


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_the_viscosity_by_rate_bears_the_mean_stress_at_the_mean_rate(point, dim, angle):
    """Along rates and stresses that are linear between two particles: the stress midway."""
    rate_i, rate_j = np.array([1.0, 0.0, 5.0]), np.array([3.0, 2.0, 5.0])
    stress_i, stress_j = 10 + 2 * rate_i, 10 + 2 * rate_j
    mu_i, mu_j = stress_i / np.maximum(rate_i, 1e-9), stress_j / rate_j
    gradients = *sheared(rate_i, dim, angle), *sheared(rate_j, dim, angle)
    _, by_rate, harmonic = point("pair_viscosity", mu_i, mu_j, *gradients, dim=dim)
    exact = (stress_i + stress_j) / (rate_i + rate_j)
    moving = rate_i > 0
    np.testing.assert_allclose(by_rate[moving], exact[moving], rtol=1e-10)
    assert abs(harmonic[0] / exact[0] - 1) > 0.05, "the control"
    at_rest = np.zeros(3)
    _, neither, _ = point(
        "pair_viscosity", mu_i, mu_j, *sheared(at_rest, dim), *sheared(at_rest, dim), dim=dim
    )
    np.testing.assert_allclose(neither, 0.5 * (mu_i + mu_j), rtol=1e-12)
