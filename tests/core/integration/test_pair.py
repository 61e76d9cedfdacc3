"""One pair of particles, whose rates can be written down."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import FIXED, ROCK, WATER, Simulations

# Two unlike particles within each other's support, at unequal densities.
FIRST, SECOND = 0, 1
SEPARATION = np.array([0.009, -0.006, 0.004])
VELOCITY = np.array([[1.0, -2.0, 0.5], [-0.5, 1.0, 2.0]])
COLUMNS = {
    "mass": [0.30, 0.09],
    "density": [2800.0, 1015.0],
    "smoothing_length": [0.011, 0.014],
    "material": [0, 1],
}
STICKY = WATER | {"nu": 0.5}


class Pair:
    """The pair in `dim` dimensions, and what the equations say about it."""

    def __init__(self, core, dim, velocity=None, **options):
        self.core, self.dim = core, dim
        self.r_ij = -SEPARATION[:dim]
        self.v_ij = np.diff((VELOCITY if velocity is None else velocity)[::-1, :dim], axis=0)[0]
        velocity = (VELOCITY if velocity is None else velocity)[:, :dim]
        simulation = Simulations(core)(
            np.array([0 * self.r_ij, -self.r_ij]), velocity,
            materials=(ROCK, STICKY), columns=COLUMNS, **options,
        )  # fmt: skip
        self.rates, self.state = simulation.rates(), simulation.state()

    def gradient_factor(self, which):
        """The gradient factor with the smoothing length of one particle."""
        physics = {2: self.core.physics.two, 3: self.core.physics.three}[self.dim]
        inverse_support = 1 / (2.5 * COLUMNS["smoothing_length"][which])
        return physics.kernel([[np.linalg.norm(self.r_ij)], [inverse_support]])[1][0]

    def gradient(self, which):
        """L of one particle by Eq. (9), embedded in three dimensions."""
        i, j = (FIRST, SECOND) if which == FIRST else (SECOND, FIRST)
        sign = 1 if which == FIRST else -1
        L = np.zeros((3, 3))
        L[: self.dim, : self.dim] = np.outer(-sign * self.v_ij, sign * self.r_ij)
        return L * COLUMNS["mass"][j] * self.gradient_factor(i) / COLUMNS["density"][i]

    def deviator(self, which):
        """D - tr(D)/3 E."""
        L = self.gradient(which)
        return 0.5 * (L + L.T) - np.trace(L) / 3 * np.eye(3)


@pytest.fixture
def pair(any_core, dim):
    """Makes the pair with given options."""
    return lambda **options: Pair(any_core, dim, **options)


@pytest.mark.parametrize("which", [FIRST, SECOND], ids=["rock", "water"])
def test_density_rate_is_equation_11(pair, which):
    made = pair()
    expected = -COLUMNS["density"][which] * np.trace(made.gradient(which))
    assert made.rates["density_rate"][which] == pytest.approx(expected, rel=1e-13)


def test_stress_rate_is_equation_4(pair):
    made = pair()
    expected = 2 * ROCK["shear_modulus"] * made.deviator(FIRST)
    rate = made.rates["deviatoric_stress_rate"]
    np.testing.assert_allclose(rate[FIRST], expected, rtol=1e-12, atol=1e-9 * abs(expected).max())
    assert (rate[SECOND] == 0).all()


def test_viscous_stress_is_equation_7(pair):
    made = pair()
    tau = 2 * COLUMNS["density"][SECOND] * STICKY["nu"] * made.deviator(SECOND)
    sigma = tau - made.state["pressure"][SECOND] * np.eye(3)
    np.testing.assert_allclose(
        made.state["stress"][SECOND], sigma, rtol=1e-9, atol=1e-9 * abs(tau).max()
    )


def test_acceleration_is_equation_12(pair, dim):
    """Without artificial viscosity: pressure of both and viscous stress of the water."""
    made = pair()
    sigma = made.state["stress"][:, :dim, :dim]
    rho = np.array(COLUMNS["density"])[:, None, None]
    mean_F = 0.5 * (made.gradient_factor(FIRST) + made.gradient_factor(SECOND))
    force = (sigma / rho**2).sum(axis=0) @ made.r_ij * mean_F
    for which, mass, sign in (
        (FIRST, COLUMNS["mass"][SECOND], 1),
        (SECOND, COLUMNS["mass"][FIRST], -1),
    ):
        np.testing.assert_allclose(
            made.rates["acceleration"][which], sign * mass * force, rtol=1e-9
        )


@pytest.mark.parametrize("balsara", [False, True])
def test_artificial_viscosity_is_equation_13(pair, balsara):
    """It pushes approaching particles apart, along the line that joins them."""
    without, made = pair(balsara=balsara), pair(alpha=0.7, balsara=balsara)
    r = np.linalg.norm(made.r_ij)
    w = made.v_ij @ made.r_ij / r
    assert w < 0
    v_sig = made.state["sound_speed"].sum() - 3 * w
    f = made.rates["balsara"].mean()
    assert (f == 1) != balsara
    Pi = -f * 0.7 * v_sig * w / sum(COLUMNS["density"])
    push = made.rates["acceleration"] - without.rates["acceleration"]
    mean_F = 0.5 * (made.gradient_factor(FIRST) + made.gradient_factor(SECOND))
    expected = -COLUMNS["mass"][SECOND] * Pi * mean_F * made.r_ij
    np.testing.assert_allclose(push[FIRST], expected, rtol=1e-9)
    assert push[FIRST] @ made.r_ij > 0
    power = -np.sum(np.array(COLUMNS["mass"])[:, None] * push * made.state["velocity"])
    assert made.rates["av_power"] == pytest.approx(power, rel=1e-9)


def test_receding_particles_feel_no_artificial_viscosity(pair):
    without, made = pair(velocity=-VELOCITY), pair(velocity=-VELOCITY, alpha=0.7)
    np.testing.assert_array_equal(made.rates["acceleration"], without.rates["acceleration"])
    assert made.rates["av_power"] == 0


@pytest.mark.parametrize("h_mode", ["constant", "eq10"])
@pytest.mark.parametrize("sym_grad", [False, True])
def test_forces_are_opposite(pair, h_mode, sym_grad):
    made = pair(alpha=1.0, h_mode=h_mode, sym_grad=sym_grad)
    forces = np.array(COLUMNS["mass"])[:, None] * made.rates["acceleration"]
    np.testing.assert_allclose(forces[FIRST], -forces[SECOND], rtol=1e-13)


def test_mean_gradient_replaces_the_own_one(pair):
    own, mean = pair(), pair(sym_grad=True)
    ratio = mean.rates["density_rate"] / own.rates["density_rate"]
    F = np.array([own.gradient_factor(FIRST), own.gradient_factor(SECOND)])
    np.testing.assert_allclose(ratio, F.mean() / F, rtol=1e-13)


def test_smoothing_length_follows_equation_10(pair, dim):
    h = pair(h_mode="eq10").state["smoothing_length"]
    expected = 1.2 * (np.array(COLUMNS["mass"]) / COLUMNS["density"]) ** (1 / dim)
    np.testing.assert_allclose(h, expected, rtol=1e-14)


def test_time_step_is_equation_18(pair):
    made = pair(alpha=1.0, cflnumber=0.05)
    w = made.v_ij @ made.r_ij / np.linalg.norm(made.r_ij)
    v_sig = made.state["sound_speed"].sum() - 3 * w
    h = np.array(COLUMNS["smoothing_length"])
    v_max = np.maximum(v_sig, 2 * made.state["sound_speed"])
    acceleration = np.linalg.norm(made.rates["acceleration"], axis=1)
    expected = min(*(0.05 * 2 * h / v_max), *(0.1 * np.sqrt(h / acceleration)))
    assert made.rates["timestep"] == pytest.approx(expected, rel=1e-13)


def test_gravity_is_added(pair, dim):
    g = [0.5, -9.8, 2.0][:dim]
    difference = pair(gravity=g).rates["acceleration"] - pair().rates["acceleration"]
    np.testing.assert_allclose(difference, [g, g], rtol=1e-9)


@pytest.mark.parametrize(
    ("tension", "clamped"),
    [("free", (False, False)), ("clamp_fluid", (False, True)), ("clamp_all", (True, True))],
)
def test_tension_is_clamped_where_asked(simulate, dim, tension, clamped):
    """Rock and water, both below their reference density."""
    simulation = simulate(
        np.eye(2, dim) * 0.01, 0.0, materials=(ROCK, WATER), tension=tension,
        columns={"density": [2700.0, 990.0], "material": [0, 1]},
    )  # fmt: skip
    pressure = simulation.state()["pressure"]
    assert tuple(pressure == 0) == clamped
    assert (pressure <= 0).all()


def test_fixed_particles_never_pull(simulate, dim):
    simulation = simulate(
        np.eye(2, dim) * 0.01, 0.0, columns={"density": 2700.0, "motion": [0, FIXED]}
    )
    pressure = simulation.state()["pressure"]
    assert pressure[0] < 0
    assert pressure[1] == 0


def test_a_pair_meets_across_a_periodic_boundary(simulate, dim):
    """Moved to both ends of the domain, the pair has the same rates."""
    position = np.zeros((2, dim))
    position[1, 0] = 0.012
    velocity = np.zeros((2, dim))
    velocity[0, 0] = 3.0
    domain = ([0.0] * dim, [0.1] * dim)
    inside, across = (
        simulate(position + start, velocity, alpha=1.0, domain=domain).rates()
        for start in (0.04, 0.0999)
    )
    for name in ("acceleration", "density_rate", "deviatoric_stress_rate"):
        np.testing.assert_allclose(across[name], inside[name], rtol=1e-9, atol=1e-9)
    assert abs(inside["acceleration"]).max() > 1
