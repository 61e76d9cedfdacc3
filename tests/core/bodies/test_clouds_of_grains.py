"""Many balls that fly into one another: what their contacts give one takes from another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ..flows import Flows

ACROSS = {2: 10, 3: 5}  # balls along an edge
RADIUS, SPACING = 0.005, 0.0104  # m
END = 4e-3  # s

HEAD = """\
dim = {dim}
scheme = "resolved"
speed_max = 5
dp = 0.005
time_max = 1
time_out = 1
gravity = {gravity}

[material.basalt]
restitution = 0.7
friction = 0.5
"""


def cloud(tmp_path: Path, dim: int) -> Any:
    """More balls than one thread takes, all on their way to the middle, and across it."""
    random = np.random.default_rng(7)
    axes = np.meshgrid(*[np.arange(ACROSS[dim])] * dim, indexing="ij")
    centres = SPACING * np.stack([axis.ravel() for axis in axes], axis=1)
    velocities = -20.0 * (centres - centres.mean(axis=0))
    velocities += random.uniform(-0.5, 0.5, velocities.shape)
    text = HEAD.format(dim=dim, gravity=[0] * dim)
    for k, (x, v) in enumerate(zip(centres, velocities, strict=True)):
        text += f'\n[body.b{k}]\nshape = "{"disc" if dim == 2 else "sphere"}"\n'
        text += f'material = "basalt"\nradius = {RADIUS}\n'
        text += f"centre = {x.tolist()}\nvelocity = {v.tolist()}\n"
    return Flows(tmp_path)(text)


def angular_momentum(grains: Any, mass: float, dim: int) -> np.ndarray:
    """About the origin, over all balls; the spins' share apart."""
    inertia = (0.5 if dim == 2 else 0.4) * mass * RADIUS**2
    spins = inertia * np.asarray(grains["spin"]).reshape(len(grains["centre"]), -1).sum(axis=0)
    centres, velocities = np.asarray(grains["centre"]), np.asarray(grains["velocity"])
    if dim == 2:
        about = np.sum(centres[:, 0] * velocities[:, 1] - centres[:, 1] * velocities[:, 0])
        return np.array([mass * about, spins[-1]])
    return np.array([mass * np.cross(centres, velocities).sum(axis=0), spins])


@pytest.mark.parametrize("dim", [2, 3])
def test_contacts_keep_momentum_and_take_energy(tmp_path, dim):
    simulation = cloud(tmp_path, dim)
    count = ACROSS[dim] ** dim
    assert count > 64, "enough to be shared among threads"
    mass = simulation.totals()["mass"] / count
    before = {name: np.array(value) for name, value in simulation.grains().items()}
    simulation.advance(limit=END, pause=END, max_steps=10**6)
    grains = simulation.grains()
    changed = np.linalg.norm(grains["velocity"] - before["velocity"], axis=1)
    assert np.mean(changed > 0.01) > 0.5, "most have met another"
    scale = mass * np.abs(before["velocity"]).sum()
    momentum = mass * (np.asarray(grains["velocity"]) - before["velocity"]).sum(axis=0)
    np.testing.assert_allclose(momentum / scale, 0.0, atol=1e-13)
    first = angular_momentum(before, mass, dim)
    orbits, spins = angular_momentum(grains, mass, dim)
    size = scale * SPACING * ACROSS[dim]
    np.testing.assert_allclose((orbits + spins - first.sum(axis=0)) / size, 0.0, atol=1e-12)
    assert np.abs(spins).max() > 1e-5 * size, "friction has turned them"
    assert 0 < np.sum(grains["velocity"] ** 2) < 0.95 * np.sum(before["velocity"] ** 2)


@pytest.mark.parametrize("dim", [2, 3])
def test_threads_change_no_bit(core, tmp_path, dim):
    states = []
    for threads in (1, 2, 3):
        core.set_threads(threads)
        simulation = cloud(tmp_path, dim)
        simulation.advance(limit=END, pause=END, max_steps=10**6)
        states.append(simulation.grains())
    for state in states[1:]:
        for name in ("centre", "velocity", "spin"):
            np.testing.assert_array_equal(state[name], states[0][name])
