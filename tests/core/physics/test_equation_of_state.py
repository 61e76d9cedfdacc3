"""The equations of state against their closed forms and by differentiation."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.materials import EQUATIONS_OF_STATE

NO_SOUND = (5 / 7) ** 1.5  # density ratio at which dp/drho vanishes
MATERIAL = pytest.mark.parametrize(
    ("rho0", "c0"), [(1000.0, 1400.0), (2750.0, 60.0)], ids=["water", "reduced-basalt"]
)

# Each law with the defaults of its own parameters, and one law with others.
LAWS = [(name, *(p.default for p in law.parameters)) for name, law in EQUATIONS_OF_STATE.items()]
GAMMAS = (1.4, 3.0, 12.0)
LAW = pytest.mark.parametrize(
    "law", [*LAWS, *(("stiffened_gas", gamma) for gamma in GAMMAS)], ids=str
)


def state_of(point, law, rho, rho0, c0):
    """p, c, u of a law (its name and the parameters of its own)."""
    name, *own = law
    return point(name, rho, rho0, c0, *own)


def derivative(f, x):
    """df/dx by sixth-order central differences with a step of 1e-3 x."""
    step = 1e-3 * x
    terms = [w * (f(x + k * step) - f(x - k * step)) for k, w in ((1, 45), (2, -9), (3, 1))]
    return sum(terms) / (60 * step)


@MATERIAL
def test_pressure_is_equation_8(point, rho0, c0):
    e = np.concatenate([np.linspace(0.1, 0.99, 90), np.linspace(1.01, 10, 90)])
    p, _, _ = point("birch_murnaghan", e * rho0, rho0, c0)
    np.testing.assert_allclose(p, 1.5 * rho0 * c0**2 * (e ** (7 / 3) - e ** (5 / 3)), rtol=1e-13)


@MATERIAL
def test_pressures_of_the_resolved_scheme(point, rho0, c0):
    e = np.array([0.9, 0.99, 1.01, 1.1])
    p, _, _ = point("linear", e * rho0, rho0, c0)
    np.testing.assert_allclose(p, rho0 * c0**2 * (e - 1), rtol=1e-13)
    p, _, _ = point("tait", e * rho0, rho0, c0)
    np.testing.assert_allclose(p, rho0 * c0**2 / 7 * (e**7 - 1), rtol=1e-12)


@pytest.mark.parametrize("gamma", GAMMAS)
@MATERIAL
def test_definition_of_a_stiffened_gas(point, gamma, rho0, c0):
    """c^2 = gamma (p + p_inf)/rho, and p = (gamma - 1) rho u - gamma p_inf of the internal energy.

    That is the bulk energy and what the gas has at rest under no pressure.
    """
    rho = rho0 * np.linspace(0.8, 1.5, 29)
    p_inf = rho0 * c0**2 / gamma
    p, c, u = point("stiffened_gas", rho, rho0, c0, gamma)
    np.testing.assert_allclose(c**2, gamma * (p + p_inf) / rho, rtol=1e-12)
    at_rest = gamma * p_inf / (gamma - 1) / rho0
    scale = gamma * p_inf / (gamma - 1)
    np.testing.assert_allclose(
        p, (gamma - 1) * rho * (u + at_rest) - gamma * p_inf, atol=1e-13 * scale
    )


@MATERIAL
def test_tait_s_equation_is_a_stiffened_gas(point, rho0, c0):
    rho = rho0 * np.linspace(0.65, 1.5, 86)
    ours, tait = point("stiffened_gas", rho, rho0, c0, 7.0), point("tait", rho, rho0, c0)
    for values, expected, scale in zip(ours, tait, (rho0 * c0**2, c0, c0**2), strict=True):
        np.testing.assert_allclose(values, expected, rtol=1e-14, atol=1e-15 * scale)


@LAW
@MATERIAL
def test_reference_state(point, law, rho0, c0):
    p, c, u = state_of(point, law, rho0, rho0, c0)
    assert p == pytest.approx(0, abs=1e-15 * rho0 * c0**2)
    assert c == pytest.approx(c0, rel=1e-15)
    assert u == pytest.approx(0, abs=1e-15 * c0**2)


@LAW
@MATERIAL
def test_sound_speed_is_the_root_of_dp_drho(point, law, rho0, c0):
    rho = rho0 * np.linspace(0.65, 3, 60)
    _, c, _ = state_of(point, law, rho, rho0, c0)
    slope = derivative(lambda r: state_of(point, law, r, rho0, c0)[0], rho)
    np.testing.assert_allclose(c**2, slope, rtol=1e-9)


@MATERIAL
def test_density_is_recovered_from_pressure(point, rho0, c0):
    """Newton's iteration with slope c^2 inverts p(rho), in few steps only if the slope is right."""
    rho = rho0 * np.linspace(0.9, 1.5, 31)
    p, _, _ = point("birch_murnaghan", rho, rho0, c0)
    found = np.full_like(rho, 1.2 * rho0)
    for _ in range(6):
        p_found, c, _ = point("birch_murnaghan", found, rho0, c0)
        found -= (p_found - p) / c**2
    np.testing.assert_allclose(found, rho, rtol=1e-13)


@LAW
@MATERIAL
def test_bulk_energy_is_the_work_of_compression(point, law, rho0, c0):
    """du/drho = p/rho^2."""
    rho = rho0 * np.linspace(0.65, 3, 60)
    p, _, _ = state_of(point, law, rho, rho0, c0)
    slope = derivative(lambda r: state_of(point, law, r, rho0, c0)[2], rho)
    np.testing.assert_allclose(slope, p / rho**2, rtol=1e-8, atol=1e-12 * c0**2 / rho0)


@MATERIAL
def test_sound_speed_has_a_floor_where_there_is_none(point, rho0, c0):
    """Below e = (5/7)^(3/2) Eq. (17) has no root; the floor is a tenth of c0."""
    _, c, _ = point("birch_murnaghan", rho0 * np.linspace(0.1, NO_SOUND, 20), rho0, c0)
    np.testing.assert_allclose(c, 0.1 * c0, rtol=1e-15)


@MATERIAL
def test_tension_is_greatest_where_sound_stops(point, rho0, c0):
    p, _, _ = point("birch_murnaghan", rho0 * np.array([0.99, 1, 1.01]) * NO_SOUND, rho0, c0)
    assert p[1] < min(p[0], p[2])
    assert p[1] == pytest.approx(-0.18480 * rho0 * c0**2, rel=1e-4)


def test_cube_root_is_exact_to_rounding(point):
    """The energy holds e^(2/3) = (cube root of e)^2, to be read from 1e-1 to 1e1."""
    e = np.geomspace(0.1, 10, 400)
    _, _, u = point("birch_murnaghan", e, 1.0, 1.0)
    squared_root = 1 + np.sign(e - 1) * np.sqrt(8 * u / 9)
    np.testing.assert_allclose(squared_root, np.cbrt(e) ** 2, rtol=4e-15)
