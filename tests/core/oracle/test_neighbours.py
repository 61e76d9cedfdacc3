"""Neighbours of arrangements that are hard to find them in, counted one by one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.compiled import load_core
from doseki.scenario.schemes import SUPPORT

from ..simulations import core_table
from .clouds import MATERIALS, particle_set
from .reference import Options

DP = 0.01
H = 1.2 * DP


def stream(random: np.random.Generator, dim: int) -> np.ndarray:
    """A flow 500 particles long and 5 deep, its spray, and one particle that has flown far."""
    lower, upper = np.zeros(dim), np.full(dim, 3 * DP)
    upper[0], upper[-1] = 5.0, 5 * DP
    flow = random.uniform(lower, upper, (2500, dim))
    spray = random.uniform(lower, np.where(np.arange(dim) == 0, 5.0, 2.0), (60, dim))
    return np.concatenate([flow, spray, np.full((1, dim), 400.0)])


def spray(random: np.random.Generator, dim: int) -> np.ndarray:
    """Pairs of particles that are far from all others."""
    one = random.uniform(0, 50.0, (100, dim))
    return np.concatenate([one, one + random.uniform(-DP, DP, one.shape)])


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("arrangement", [stream, spray])
def test_every_neighbour_is_found_once(
    arrangement: Callable[[np.random.Generator, int], np.ndarray], dim: int
) -> None:
    position = arrangement(np.random.default_rng(3), dim)
    n = len(position)
    no_box = {"domain_min": [0.0] * dim, "domain_max": [0.0] * dim, "periodic": [False] * dim}
    options = Options(**no_box).of_core() | {"gravity": [0.0] * dim, "skin": 0.05}
    materials = [core_table(**vars(MATERIALS[0]))]
    core = load_core().Simulation("ueta2022", dim, "double", materials, options)
    cloud = particle_set(
        position,
        density=np.full(n, 1000.0),
        mass=np.full(n, 1000.0 * DP**dim),
        smoothing_length=np.full(n, H),
    )
    core.add_particles(**{k: np.ascontiguousarray(v) for k, v in vars(cloud).items()})
    core.start()
    near = cKDTree(position).query_ball_point(position, SUPPORT * H, return_length=True) - 1
    counts = core.neighbour_counts()
    assert near.sum() > n / 2
    np.testing.assert_array_equal(counts["count"], near)
