"""What is stretched beyond the minimum of Eq. (8) expands no further; it can be compressed."""

from __future__ import annotations

import pytest

from ..simulations import Simulations

VOID = (5 / 7) ** 1.5  # rho/rho0 at which p(rho) has its minimum


def density_rate(simulate: Simulations, ratio: float, approach: float) -> float:
    """drho/dt of the first of two particles 10 mm apart; approach > 0: they come nearer."""
    simulation = simulate(
        [[0.0, 0.0], [0.01, 0.0]],
        [[approach, 0.0], [-approach, 0.0]],
        columns={"density": [2750.0 * ratio] * 2},
    )
    return simulation.rates()["density_rate"][0]


@pytest.mark.parametrize("ratio", [0.5, 0.6])
def test_a_void_does_not_expand(simulate: Simulations, ratio: float):
    assert ratio < VOID
    assert density_rate(simulate, ratio, approach=-1.0) == 0.0


@pytest.mark.parametrize("ratio", [0.5, 0.6])
def test_a_void_is_compressed_like_anything_else(simulate: Simulations, ratio: float):
    full = density_rate(simulate, 1.0, approach=1.0)
    assert full > 0.0
    # Eq. (11) does not contain the density of i: -rho div v = sum_j m_j v_ij . grad W.
    assert density_rate(simulate, ratio, approach=1.0) == pytest.approx(full, rel=1e-12)


def test_above_it_matter_expands(simulate: Simulations):
    assert density_rate(simulate, 0.61, approach=-1.0) < 0.0
