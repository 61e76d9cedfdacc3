"""The stress of a sheared body turns with the body, not against it."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import ROCK, lattice, run_to

# So soft that hardly anything changes the motion: every particle keeps its velocity.
JELLY = ROCK | {"speedsound": 0.5, "shear_modulus": 1e-3}
RATE = 10.0  # of strain and of rotation, 1/s


def jaumann(L, mu, time, steps=2000):
    """S after `time` of the constant gradient L, by Eq. (4)."""
    D = 0.5 * (L + L.T) - np.trace(L) / 3 * np.eye(3)
    spin = 0.5 * (L - L.T)

    def rate(S):
        return 2 * mu * D + spin @ S - S @ spin

    S = np.zeros((3, 3))
    for _ in range(steps):
        S = S + time / steps * rate(S + 0.5 * time / steps * rate(S))
    return S


def test_stress_of_a_shear_flow(simulate, dim):
    """v_x = d x - w y, v_y = w x - d y with d = w: a simple shear at 45 degrees, steady since
    L L = 0.  A gradient read the wrong way round gives S_xy the other sign.
    """
    L = np.zeros((3, 3))
    L[:2, :2] = RATE * np.array([[1, -1], [1, -1]])
    position = lattice((11, 11) if dim == 2 else (9, 9, 9))
    simulation = simulate(position, position @ L[:dim, :dim].T, materials=(JELLY,))
    middle = np.argmin(np.linalg.norm(position, axis=1))
    S = run_to(simulation, 0.02).state()["deviatoric_stress"][middle]
    expected = jaumann(L, JELLY["shear_modulus"], 0.02)
    assert expected[0, 1] > 0.15 * expected[0, 0]
    np.testing.assert_allclose(S, expected, atol=0.03 * abs(expected).max())
    assert np.trace(S) == pytest.approx(0, abs=1e-12 * abs(S).max())
