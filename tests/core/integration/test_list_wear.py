"""Neighbour lists are built anew when, and only when, particles have come nearer to one another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.scenario.schemes import SUPPORT

from ..simulations import FIXED, WATER, Simulations

DP = 0.01
SIZE = {2: 0.4, 3: 0.16}  # of the periodic box [m]: three cells of ListWear and more
FAST = 20.0  # m/s
RADIUS = SUPPORT * 1.2 * DP  # of support [m]
SKIN = 0.1 * RADIUS


def lattice(dim: int) -> np.ndarray:
    """A lattice, disturbed a little so that no neighbour is just as far as the support reaches."""
    axis = np.arange(DP / 2, SIZE[dim], DP)
    position = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    random = np.random.default_rng(2)
    return position + random.uniform(-0.05 * DP, 0.05 * DP, position.shape)


def flow(simulate: Simulations, velocity: np.ndarray, **options: Any) -> Any:
    """Water that fills a periodic box, without pressure of its own."""
    dim = velocity.shape[1]
    corners = [0.0] * dim, [SIZE[dim]] * dim
    return simulate(lattice(dim), velocity, materials=(WATER,), dp=DP, domain=corners, **options)


def layers(dim: int, speeds: tuple[float, ...]) -> np.ndarray:
    """Velocities along x of as many layers, one over the other."""
    position = lattice(dim)
    layer = (position[:, -1] / SIZE[dim] * len(speeds)).astype(int)
    velocity = np.zeros_like(position)
    velocity[:, 0] = np.array(speeds)[layer]
    return velocity


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("direction", [0, 1])
def test_particles_that_move_side_by_side_wear_no_list(
    simulate: Simulations, dim: int, direction: int
) -> None:
    velocity = np.zeros_like(lattice(dim))
    velocity[:, direction], velocity[:, -1] = FAST, FAST / 2
    run = flow(simulate, velocity)
    built = run.rebuilds
    end = 4 * SKIN / np.linalg.norm(velocity[0])
    run.advance(limit=end, pause=end, max_steps=1000)
    assert run.time == end
    assert run.rebuilds == built


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("speeds", [(FAST, 0.0), (FAST, -FAST), (0.0, FAST, FAST, -FAST)])
def test_neighbours_are_found_while_layers_slide(
    simulate: Simulations, dim: int, speeds: tuple[float, ...]
) -> None:
    run = flow(simulate, layers(dim, speeds))
    built, steps = run.rebuilds, 0
    while run.rebuilds < built + 3:
        run.advance(limit=1.0, pause=1.0, max_steps=1)
        steps += 1
        state = run.state()
        tree = cKDTree(state["position"] % SIZE[dim], boxsize=SIZE[dim])
        near = tree.query_ball_point(tree.data, RADIUS, return_length=True) - 1
        np.testing.assert_array_equal(run.neighbour_counts()["count"], near)
    assert steps > 6  # lists served more than one step


def test_a_particle_that_crosses_still_ones_wears_lists_out(simulate: Simulations) -> None:
    position = lattice(2)
    keep = position[:, 1] > 4 * DP
    still = position[keep]
    shot = np.array([[DP, 2.0 * DP]])
    velocity = np.zeros((len(still) + 1, 2))
    velocity[-1] = FAST, 0.0
    motion = np.full(len(still) + 1, FIXED, dtype=np.int8)
    motion[-1] = 0
    run = simulate(
        np.concatenate([still, shot]), velocity, materials=(WATER,), dp=DP,
        columns={"motion": motion}, domain=([0.0, 0.0], [SIZE[2], SIZE[2]]),
    )  # fmt: skip
    built = run.rebuilds
    run.advance(limit=1.05 * SKIN / FAST, pause=1.0, max_steps=1000)
    assert run.rebuilds == built + 1
