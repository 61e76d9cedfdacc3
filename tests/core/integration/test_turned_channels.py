"""A channel is the same whichever axis is upwards."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.running import moving

from ..flows import advance

CHANNEL = """\
dim = 2
scheme = "resolved"
speed_max = 2
dp = 0.01
time_max = 1
time_out = 1
gravity = {gravity}
turbulence = "mixing_length"
periodic = ["{along}"]
domain_min = {low}
domain_max = {high}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.01
normal = {normal}
min = {bed_low}
max = {bed_high}

[body.water]
shape = "box"
material = "water"
min = {water_low}
max = {water_high}
velocity = {velocity}
"""
TURNS = {0: [[1, 0], [0, 1]], 90: [[0, -1], [1, 0]], 180: [[-1, 0], [0, -1]]}
CORNERS = {
    "bed": ([0.003, -0.03], [0.163, 0]),
    "water": ([0.003, 0], [0.163, 0.06]),
    "domain": ([0.003, -1], [0.163, 1]),
}


def turned_channel(flows, turn):
    """Its simulation, and the matrix that turns it."""
    R = np.array(TURNS[turn], float)
    places = {}
    for name, ends in CORNERS.items():
        turned = np.array(ends) @ R.T
        low, high = turned.min(axis=0).tolist(), turned.max(axis=0).tolist()
        keys = ("low", "high") if name == "domain" else (f"{name}_low", f"{name}_high")
        places |= dict(zip(keys, (low, high), strict=True))
    text = CHANNEL.format(
        gravity=(R @ [1.0, -9.8]).tolist(), along="xy"[int(abs(R[1, 0]))],
        normal=(R @ [0, 1]).tolist(), velocity=(R @ [1.2, 0]).tolist(), **places,
    )  # fmt: skip
    return advance(flows(text), 200), R


@pytest.mark.parametrize("turn", [90, 180])
def test_mixing_lengths_are_those_of_the_flow_that_was_turned(flows, turn):
    first, _ = turned_channel(flows, 0)
    other, R = turned_channel(flows, turn)
    along, turned = (
        np.sort(moving(run.state())["velocity"] @ Q, axis=0)
        for run, Q in ((first, np.eye(2)), (other, R))
    )
    assert along[:, 0].max() > 1
    np.testing.assert_allclose(turned, along, atol=1e-9)
