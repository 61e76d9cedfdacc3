"""Which body a bound particle belongs to, and the spin of a body whose inertia has all entries."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from doseki.record.particles import BOUND
from doseki.solver.build import filled_simulation

from ..flows import Flows
from .test_grains import TWO_BALLS

BALLS = TWO_BALLS.format(dim="{dim}", law="linear", restitution=1)


def unstarted(tmp_path: Any, dim: int) -> Any:
    """Two balls that have not been started, in the core."""
    return filled_simulation(Flows(tmp_path).scenario(BALLS.replace("{dim}", str(dim))))[0]


def add_particle(simulation: Any, dim: int) -> None:
    """Adds a bound particle far from everything."""
    none, one = np.zeros(1, np.int32), np.ones(1)
    simulation.add_particles(
        position=np.full((1, dim), 3.0),
        velocity=np.zeros((1, dim)),
        mass=one,
        density=1000 * one,
        smoothing_length=0.002 * one,
        material=none,
        body=none,
        motion=np.full(1, BOUND, np.int32),
        id=np.full(1, 10**6, np.int64),
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_a_bound_particle_of_no_body_stays_alone(tmp_path, dim):
    simulation = unstarted(tmp_path, dim)
    add_particle(simulation, dim)
    simulation.start()
    simulation.advance(limit=1e9, pause=1e9, max_steps=3)
    state = simulation.state()
    np.testing.assert_array_equal(np.unique(state["grain"][:-1]), [0, 1])
    assert state["grain"][-1] == -1
    np.testing.assert_array_equal(state["position"][-1], 3.0)


def test_spin_follows_from_angular_momentum_with_a_full_inertia(tmp_path):
    """L = I w when the body is added, w = I^-1 L when it is looked at."""
    simulation = unstarted(tmp_path, 3)
    random = np.random.default_rng(5)
    A = random.normal(size=(3, 3))
    inertia, spin = 1e-5 * (np.eye(3) + A @ A.T), np.array([[3.0, -5.0, 7.0]])
    turn = random.normal(size=(1, 4))
    whole = {name: np.zeros(1, np.int32) for name in ("shape", "material", "body")}
    simulation.add_rigid_bodies(
        whole
        | {
            "fixed": np.zeros(1, bool),
            "centre": np.full((1, 3), 2.0),
            "orientation": turn / np.linalg.norm(turn),
            "velocity": np.zeros((1, 3)),
            "spin": spin,
            "mass": np.full(1, 2.0),
            "inertia": inertia[None],
        }
    )
    np.testing.assert_allclose(simulation.grains()["spin"][-1:], spin, rtol=1e-12)
