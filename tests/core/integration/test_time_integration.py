"""The leap-frog scheme is of second order and conserves what it should."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import ROCK, colliding_grains, run_to

SOFT = ROCK | {"shear_modulus": 0.0}


def approaching_pair(simulate, dim, cflnumber, **options):
    """Two one-particle grains, 13 mm apart, that approach at 6 m/s slightly off centre."""
    position, velocity = np.zeros((2, dim)), np.zeros((2, dim))
    position[1, :2] = 0.013, 0.003
    velocity[1, 0] = -6.0
    return simulate(position, velocity, cflnumber=cflnumber, cfl_force=cflnumber, **options)


@pytest.mark.parametrize("alpha", [0.0, 1.0])
@pytest.mark.parametrize("material", [SOFT, ROCK], ids=["no-strength", "strength"])
def test_positions_are_of_second_order(simulate, dim, material, alpha):
    """Halving the time step quarters the error, here at the height of a collision."""
    end = 8e-4

    def position(cflnumber):
        options = {"materials": (material,), "alpha": alpha}
        simulation = run_to(approaching_pair(simulate, dim, cflnumber, **options), end)
        return simulation.state()["position"]

    exact = position(0.0025)
    errors = [np.abs(position(cflnumber) - exact).max() for cflnumber in (0.02, 0.01)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)
    assert errors[0] < 1e-4 * 0.01  # of the spacing


def energy(simulation):
    """All energy there is, with what the artificial viscosity has taken."""
    totals = simulation.totals()
    kinds = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")
    return sum(totals[kind] for kind in kinds)


@pytest.mark.parametrize("alpha", [0.0, 1.0])
def test_energy_error_is_of_second_order(simulate, dim, alpha):
    """At the height of a collision, without strength: pressure and dissipation are exact."""
    errors = []
    for cflnumber in (0.04, 0.02):
        simulation = approaching_pair(simulate, dim, cflnumber, materials=(SOFT,), alpha=alpha)
        before = energy(simulation)
        errors.append(abs(energy(run_to(simulation, 8e-4)) / before - 1))
    assert errors[1] < 1e-5
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)


def test_energy_with_strength(simulate, dim):
    """S:S/(4 mu rho) is the work of the stress only while rho stays near rho0, here within 5 %."""
    simulation = approaching_pair(simulate, dim, 0.02)
    before = energy(simulation)
    assert energy(run_to(simulation, 8e-4)) == pytest.approx(before, rel=3e-3)


@pytest.mark.parametrize("alpha", [0.0, 1.0])
def test_energy_of_a_collision(simulate, dim, alpha):
    """Kinetic, bulk, shear and dissipated energy add up to what there was."""
    grains = colliding_grains(dim)
    simulation = simulate(grains.position, grains.velocity, alpha=alpha)
    before = energy(simulation)
    run_to(simulation, 3e-3)
    totals = simulation.totals()
    assert totals["kinetic_energy"] < 0.9 * before  # something did happen
    assert energy(simulation) == pytest.approx(before, rel=2e-3)
    assert (totals["av_dissipation"] > 0) == (alpha > 0)


@pytest.mark.parametrize("alpha", [0.0, 1.0])
def test_momentum_of_a_collision(simulate, dim, alpha):
    """Every force has its opposite: the total keeps its value to rounding."""
    grains = colliding_grains(dim)
    simulation = simulate(grains.position, grains.velocity + 0.7, alpha=alpha)
    before = np.array(simulation.totals()["momentum"])
    assert (before != 0).all()
    after = np.array(run_to(simulation, 3e-3).totals()["momentum"])
    assert np.abs(after - before).max() < 1e-13 * np.abs(before).max()


def angular_momentum(simulation):
    """About the z axis."""
    state = simulation.state()
    x, v = state["position"], state["velocity"]
    return np.sum(state["mass"] * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]))


@pytest.mark.parametrize("alpha", [0.0, 1.0])
def test_angular_momentum_without_strength(simulate, dim, alpha):
    """Pressure and artificial viscosity act along the line between two particles."""
    grains = colliding_grains(dim)
    simulation = simulate(grains.position, grains.velocity, materials=(SOFT,), alpha=alpha)
    before = angular_momentum(simulation)
    assert angular_momentum(run_to(simulation, 3e-3)) == pytest.approx(before, rel=1e-12)


def test_uniform_motion_changes_nothing(simulate, dim):
    """A collision seen from a moving frame is the same collision."""
    grains = colliding_grains(dim)
    moving = np.array([3.0, -2.0, 1.0])[:dim]
    at_rest, in_motion = (
        run_to(simulate(grains.position, grains.velocity + v, alpha=1.0), 2e-3).state()
        for v in (np.zeros(dim), moving)
    )
    np.testing.assert_allclose(
        in_motion["position"] - moving * 2e-3, at_rest["position"], rtol=0, atol=1e-10
    )
    np.testing.assert_allclose(in_motion["velocity"] - moving, at_rest["velocity"], atol=1e-6)


def test_free_fall_is_exact(simulate, dim):
    """One particle under gravity follows the parabola, whatever the steps."""
    g = np.array([1.0, -9.8, 0.5])[:dim]
    simulation = simulate(np.zeros((1, dim)), 2.0, gravity=list(g))
    state = run_to(simulation, 0.25).state()
    np.testing.assert_allclose(state["position"][0], 2.0 * 0.25 + 0.5 * g * 0.25**2, rtol=1e-11)
    np.testing.assert_allclose(state["velocity"][0], 2.0 + 0.25 * g, rtol=1e-11)
