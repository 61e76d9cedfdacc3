"""Which body a bound particle belongs to, and the spin of a body whose inertia has all entries."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from doseki.record.particles import BOUND
from doseki.scene.lattices import rotation_matrix
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


FREE_BOX = """
dim = 3
scheme = "resolved"
dp = 0.1
time_max = 20
time_out = 20
gravity = [0, 0, 0]
speed_max = 3
[body.box]
shape = "box"
material = "basalt"
min = [-0.3, -0.2, -0.1]
max = [0.3, 0.2, 0.1]
spin = {spin}
rotate = {angle}
rotate_axis = [1, 2, 3]
"""


def spins_of_euler(spin, moments, times):
    """About the axes of a body that nothing touches, by Euler's equations (Runge-Kutta)."""

    def rate(w):
        return np.cross(moments * w, w) / moments

    spins, w, steps = [], np.array(spin, float), 200
    for length in np.diff(times, prepend=0.0):
        h = length / steps
        for _ in range(steps):
            a = rate(w)
            b = rate(w + h / 2 * a)
            c = rate(w + h / 2 * b)
            w = w + h / 6 * (a + 2 * b + 2 * c + rate(w + h * c))
        spins.append(w)
    return np.array(spins)


@pytest.mark.parametrize("angle", [0.0, 37.0])
@pytest.mark.parametrize("spin", [[0.5, 5.0, 0.5], [3.0, 1.0, 2.0]])
def test_what_turns_freely_keeps_its_energy(flows, spin, angle):
    """Also about its middle axis, where it turns over and over (Dzhanibekov)."""
    turn = rotation_matrix(angle, 3, np.array([1, 2, 3]))
    simulation = flows(FREE_BOX.format(spin=(turn @ spin).tolist(), angle=angle))
    edges = np.array([0.6, 0.4, 0.2])
    moments = (edges @ edges - edges**2) / 12
    times, energies, spins = np.arange(1, 41) * 0.5, [], []
    for time in times:
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        grains = simulation.grains()
        w, x, y, z = grains["orientation"][0]
        half = np.arctan2(np.linalg.norm((x, y, z)), w)
        R = rotation_matrix(np.degrees(2 * half), 3, np.array([x, y, z]))
        own = R.T @ grains["spin"][0]
        spins.append(own), energies.append(moments @ own**2)
    exact = spins_of_euler(spin, moments, times)
    np.testing.assert_allclose(energies, moments @ np.array(spin) ** 2, rtol=1e-4)
    np.testing.assert_allclose(spins, exact, atol=0.05 * np.linalg.norm(spin))
