"""Solids that yield: their stress stays on the surface, their tension within the cut."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import ROCK, lattice, run_to

RATE = 100.0  # 1/s
TIME = 2.5e-4  # s: an elastic shear of mu RATE TIME = 2.1e5 Pa, before waves come in from the sides
STRENGTH = 1e5  # Pa
SOFT = {"cohesion": 2e4, "friction_angle": 30.0}
COHESIONLESS = {"cohesion": 0.0, "friction_angle": 30.0}


def deformed(simulate, dim, axes, rate=RATE, **strength):
    """The inner particles of a block whose velocity is v_a = rate x_b, after TIME."""
    L = np.zeros((dim, dim))
    L[axes] = rate
    position = lattice((13, 13) if dim == 2 else (9, 9, 9))
    run = simulate(position, position @ L.T, materials=(ROCK | strength,))
    state = run_to(run, TIME).state()
    inner = np.all(np.abs(position) < 0.025, axis=1)
    return {key: values[inner] for key, values in state.items()}


def root_j2(state):
    """sqrt(S:S/2) of each particle, Pa."""
    return np.sqrt(0.5 * np.sum(state["deviatoric_stress"] ** 2, axis=(1, 2)))


def test_von_mises_in_shear(simulate, dim):
    elastic = deformed(simulate, dim, (0, 1))
    plastic = deformed(simulate, dim, (0, 1), yield_strength=STRENGTH)
    limit = STRENGTH / np.sqrt(3)
    assert root_j2(elastic).max() > 2 * limit
    assert root_j2(plastic).max() <= limit * (1 + 1e-12)
    assert np.median(root_j2(plastic)) == pytest.approx(limit, rel=1e-3)


def cone(simulate, dim, strength):
    """(alpha, k) of a material."""
    physics = simulate.core.physics.two if dim == 2 else simulate.core.physics.three
    (alpha,), (k,) = physics.drucker_prager([[strength["cohesion"]], [np.pi / 6]])
    return alpha, k


@pytest.mark.parametrize("rate", [-RATE, RATE], ids=["pressed", "stretched"])
def test_drucker_prager_in_compression(simulate, dim, rate):
    """sqrt(J2) <= k + 3 alpha p for every particle, whatever its pressure."""
    alpha, k = cone(simulate, dim, SOFT)
    state = deformed(simulate, dim, (0, 0), rate, **SOFT)
    limit = k + 3 * alpha * state["pressure"]
    assert np.all(root_j2(state) <= limit * (1 + 1e-9) + 1e-6)
    assert root_j2(deformed(simulate, dim, (0, 0), rate)).max() > 1.2 * limit.min()


@pytest.mark.parametrize("strength", [SOFT, COHESIONLESS], ids=["cohesion", "sand"])
def test_tension_stays_within_the_cut(simulate, dim, strength):
    alpha, k = cone(simulate, dim, strength)
    elastic = deformed(simulate, dim, (0, 0))
    torn = deformed(simulate, dim, (0, 0), **strength)
    cut = -k / (3 * alpha)
    assert elastic["pressure"].min() < 1.5 * cut - 1e4
    assert torn["pressure"].min() >= cut * (1 + 1e-12)
    np.testing.assert_allclose(root_j2(torn)[torn["pressure"] <= cut], 0, atol=1e-6)


def test_strength_off_by_default_and_without_deviator(simulate, dim):
    """Zero strengths are an elastic solid, to the last bit."""
    plain = deformed(simulate, dim, (0, 1))
    zeros = deformed(simulate, dim, (0, 1), yield_strength=0.0, cohesion=0.0, friction_angle=0.0)
    np.testing.assert_array_equal(plain["stress"], zeros["stress"])
