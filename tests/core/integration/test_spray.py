"""Spray that comes together is water, not a foam that keeps its particles apart, Eq. (147)."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows

# Single particles, APART spacings from each other, that a force draws to their middle.
SPRAY = """\
dim = {dim}
scheme = "resolved"
speed_max = 1
dp = 0.01
time_max = 4
time_out = 1
gravity = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
attraction = 4
"""
PARTICLE = """
[body.p{number}]
shape = "box"
material = "water"
min = {low}
max = {high}
"""
ACROSS, APART, DP = {2: 7, 3: 4}, 2.4, 0.01


def spray(dim: int, turn: float) -> str:
    """The scenario, its particles turned about the middle."""
    row = APART * DP * (np.arange(ACROSS[dim]) - 0.5 * (ACROSS[dim] - 1))
    places = np.stack(np.meshgrid(*(dim * [row])), -1).reshape(-1, dim)
    x, y = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0] = np.cos(turn) * x - np.sin(turn) * y
    places[:, 1] = np.sin(turn) * x + np.cos(turn) * y
    half = 0.49 * DP
    return SPRAY.format(dim=dim) + "".join(
        PARTICLE.format(number=k, low=(place - half).tolist(), high=(place + half).tolist())
        for k, place in enumerate(places)
    )


@pytest.mark.parametrize(("dim", "turn"), [(2, 0.0), (2, 0.4), (3, 0.0), (3, 0.4)])
def test_spray_that_comes_together_has_the_volume_of_water(tmp_path, dim, turn):
    simulation = Flows(tmp_path)(spray(dim, turn))
    simulation.advance(limit=4.0, pause=4.0, max_steps=10**6)
    place = simulation.state()["position"][:, :dim]
    found = np.sqrt((place**2).sum(1).mean())
    count = ACROSS[dim] ** dim
    radius = DP * (count / np.pi) ** 0.5 if dim == 2 else DP * (0.75 * count / np.pi) ** (1 / 3)
    expected = radius * np.sqrt(dim / (dim + 2))  # of a disc or ball of that volume
    assert found == pytest.approx(expected, rel=0.05)  # 1.9 times as wide where spray is a foam
