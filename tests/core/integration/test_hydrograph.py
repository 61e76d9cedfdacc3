"""Inflows whose speed changes: what has entered is the integral of the hydrograph."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import FOREVER, WATER, run_to
from .test_sources import DP, DRIVEN, inflow

TIMES = np.array([0.01, 0.05, 0.09, 0.12, 0.2])
SPEEDS = np.array([0.0, 1.2, 1.2, 0.0, 0.6])


def mass(dim):
    """Of a particle at the density of water; sums of it are exact."""
    return 1000.0 * DP**dim


def gone(times):
    """Distances of layers, m, by fine quadrature that knows nothing of parabolas."""
    fine = np.linspace(TIMES[0], TIMES[-1], 400_001)
    speed = np.interp(fine, TIMES, SPEEDS)
    steps = np.concatenate([[0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))])
    return np.interp(times, fine, steps)


@pytest.fixture
def river(simulate, dim):
    """One inflow that swells, ebbs to nothing and swells again; one particle far away."""
    table = {"times": TIMES.tolist(), "speeds": SPEEDS.tolist(), "distances": gone(TIMES).tolist()}
    section = inflow(dim) | table | {"mass": mass(dim)}
    for key in ("speed", "start", "stop"):
        del section[key]
    return simulate(
        np.full((1, dim), 5.0), 0.0, materials=(WATER,), alpha=1.0, tension="clamp_fluid", dp=DP,
        columns={"mass": mass(dim)}, inflows=(section,),
    )  # fmt: skip


def test_ledger_closes_to_half_a_layer_at_every_step(river, dim):
    layer = mass(dim) * 3 * (dim - 1)
    while river.time < 0.21:
        river.advance(limit=0.21, pause=river.time + 2e-3, max_steps=FOREVER)
        totals = river.totals()
        asked = layer * gone(river.time) / DP
        assert totals["mass_asked"] == pytest.approx(asked, rel=1e-6, abs=1e-9)
        assert abs(totals["mass_entered"] - asked) <= 0.5 * layer * (1 + 1e-6)
        assert totals["mass_initial"] + totals["mass_entered"] == totals["mass"]
    assert totals["mass_entered"] > 10 * layer


def test_driven_particles_have_the_speed_of_the_moment_and_stay_in_layers(river, dim):
    for time in (0.03, 0.06, 0.1, 0.119, 0.15):
        state = run_to(river, time).state()
        driven = state["motion"] == DRIVEN
        assert driven.sum() == 4 * 3 * (dim - 1)
        np.testing.assert_allclose(
            state["velocity"][driven, 0], np.interp(time, TIMES, SPEEDS), atol=1e-12
        )
        x = np.unique(np.round(state["position"][driven, 0], 9))
        phase = (gone(time) / DP - 0.5) % 1.0
        np.testing.assert_allclose((x / DP) % 1.0, phase, atol=2e-5)


def test_the_speed_of_a_layer_is_its_speed_at_the_section(river, dim):
    """Released with what the table says then: 1.2 m/s on the plateau."""
    run_to(river, 0.085)
    state = river.state()
    fresh = (state["motion"] == 0) & (state["position"][:, 0] < DP)
    assert fresh.sum() == 3 * (dim - 1)
    np.testing.assert_allclose(state["velocity"][fresh, 0], 1.2, rtol=0.05)
