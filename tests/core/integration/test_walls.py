"""Fixed bodies with a prescribed motion: where they are, how fast, and what they push."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ..simulations import FIXED, WATER, lattice, run_to

START, STOP, GONE = 0.0021, 0.0513, 0.0632
NEVER = math.inf


def motion(dim, **given):
    """A motion of body 0 that does nothing, with `given` in it."""
    return {
        "body": 0, "velocity": [0.0] * dim, "angular_velocity": [0.0, 0.0, 0.0],
        "pivot": [0.0] * dim, "start": START, "stop": STOP, "removed_at": NEVER,
    } | given  # fmt: skip


@pytest.fixture
def plate(simulate, dim):
    """Makes a plate (body 0) with a motion, and a far particle of body 1."""

    def make(**given):
        wall = lattice((4, 2) if dim == 2 else (4, 3, 2)) + 0.1
        position = np.concatenate([wall, np.full((1, dim), 3.0)])
        body = np.repeat([0, 1], [len(wall), 1])
        simulation = simulate(
            position, 0.0, materials=(WATER,), columns={"motion": 1 - body, "body": body},
            motions=(motion(dim, **given),),
        )  # fmt: skip
        return simulation, wall

    return make


def of_wall(simulation):
    state = simulation.state()
    wall = state["body"] == 0
    return state["position"][wall], state["velocity"][wall]


def test_translation_from_start_to_stop(plate, dim):
    velocity = np.array([0.7, -0.4, 0.2])[:dim]
    simulation, wall = plate(velocity=velocity.tolist())
    for time in (0.001, 0.02, 0.05, 0.06):
        x, v = of_wall(run_to(simulation, time))
        moving = START <= time < STOP
        since = np.clip(time, START, STOP) - START
        np.testing.assert_allclose(x, wall + velocity * since, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(v, np.broadcast_to(velocity * moving, v.shape))


def rotated(x, pivot, spin, angle):
    """Rodrigues' formula, with matrices."""
    k = np.array(spin) / np.linalg.norm(spin)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    dim = x.shape[1]
    return pivot + (x - pivot) @ turn[:dim, :dim].T


def test_rotation_is_rigid_and_exact(plate, dim):
    spin = [0.0, 0.0, 30.0] if dim == 2 else [10.0, -20.0, 15.0]
    drift, pivot = np.array([0.3, 0.1, -0.2])[:dim], np.full(dim, 0.11)
    simulation, wall = plate(velocity=drift.tolist(), angular_velocity=spin, pivot=pivot.tolist())
    x, v = of_wall(run_to(simulation, 0.04))
    since = 0.04 - START
    expected = rotated(wall, pivot, spin, np.linalg.norm(spin) * since) + drift * since
    np.testing.assert_allclose(x, expected, rtol=0, atol=1e-13)
    arm = np.zeros((len(x), 3))
    arm[:, :dim] = x - (pivot + drift * since)
    np.testing.assert_allclose(v, drift + np.cross(spin, arm)[:, :dim], atol=1e-12)


def test_a_gate_vanishes_at_its_time(plate, dim):
    simulation, wall = plate(removed_at=GONE)
    assert len(run_to(simulation, 0.999 * GONE)) == len(wall) + 1
    assert len(run_to(simulation, GONE)) == 1
    run_to(simulation, 0.08)
    assert simulation.time == 0.08


def test_a_fixed_particle_with_a_velocity_is_a_belt_that_stays(simulate, dim):
    simulation = simulate(np.array([[0.0] * dim, [1.0] * dim]), 0.5, columns={"motion": [FIXED, 0]})
    state = run_to(simulation, 0.01).state()
    np.testing.assert_array_equal(state["position"][0], 0.0)
    np.testing.assert_array_equal(state["velocity"][0], 0.5)


def piston(simulate, dim, skin):
    """A wall that runs into a block of water at rest."""
    across = (4,) * (dim - 1)
    wall, water = lattice((3, *across)), lattice((6, *across))
    wall[:, 0] -= 0.065
    body = np.repeat([0, 1], [len(wall), len(water)])
    return simulate(
        np.concatenate([wall, water]), 0.0, materials=(WATER,), alpha=1.0, skin=skin,
        columns={"motion": 1 - body, "body": body},
        motions=(motion(dim, velocity=[2.0] + [0.0] * (dim - 1), start=0.0, stop=0.03),),
    )  # fmt: skip


def test_a_moving_wall_pushes_and_its_motion_counts_in_the_skin(simulate, dim):
    """With lists that are made anew at every step nothing may be different but rounding."""
    pushed = run_to(piston(simulate, dim, 0.15), 0.02)
    state, exact = pushed.state(), run_to(piston(simulate, dim, 0.0), 0.02).state()
    water = state["body"] == 1
    assert state["velocity"][water, 0].mean() > 0.5
    assert 1 < pushed.rebuilds < pushed.steps
    np.testing.assert_allclose(state["position"], exact["position"], atol=1e-9)
