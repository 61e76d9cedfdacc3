"""A body in a stream knows no direction but those of its shape and of the stream."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ..flows import Flows

STREAM = """\
dim = {dim}
scheme = "resolved"
speed_max = 1
dp = 0.01
time_max = 1
time_out = 1
gravity = {gravity}
periodic = {axes}
domain_min = {low}
domain_max = {high}

[body.water]
shape = "box"
material = "water"
min = {low}
max = {high}
velocity = {stream}

[body.stone]
material = "basalt"
"""
BODIES = {
    "box": 'shape = "box"\nmin = {low}\nmax = {high}\n',
    "ball": 'shape = "sphere"\ncentre = {middle}\nradius = 0.035\n',
    "solid": 'shape = "stl"\nfile = "solid.stl"\n',
}


def stone(
    folder: Path, body: str, stream: np.ndarray, half: float, seconds: float, more: str = ""
) -> dict[str, np.ndarray]:
    """A body some time after its release in water of the periodic box [-half, half]^dim.

    Gravity pulls along the stream.
    """
    dim = len(stream)
    text = STREAM.format(
        dim=dim,
        gravity=(10 * stream).tolist(),
        axes=list("xyz"[:dim]),
        low=[-half] * dim,
        high=[half] * dim,
        stream=stream.tolist(),
    ) + BODIES[body].format(low=[-0.03] * dim, high=[0.03] * dim, middle=[0.0] * dim)
    simulation: Any = Flows(folder)(text + more)
    simulation.advance(limit=seconds, pause=seconds, max_steps=10**9)
    return simulation.grains()


def force(folder: Path, body: str, stream: np.ndarray) -> np.ndarray:
    """Of the water on a body after some steps."""
    half, seconds = {2: (0.1, 5e-3), 3: (0.08, 1e-3)}[len(stream)]
    return np.array(stone(folder, body, stream, half, seconds)["flow_force"][0])


def moves(dim: int) -> list[np.ndarray]:
    """A quarter turn, an exchange of axes and a mirror, of which all symmetries are made."""
    quarter = np.eye(dim)
    quarter[:2, :2] = [[0, -1], [1, 0]]
    return [quarter, np.roll(np.eye(dim), 1, axis=0), np.diag([-1.0] + [1.0] * (dim - 1))]


@pytest.mark.parametrize(
    ("dim", "body"), [(2, "box"), (2, "ball"), (3, "box"), (3, "ball"), (3, "solid")]
)
def test_forces_turn_with_the_stream(tmp_path, dim, body):
    import trimesh

    corners = 0.045 * np.concatenate([np.eye(3), -np.eye(3)])
    trimesh.convex.convex_hull(corners).export(tmp_path / "solid.stl")
    stream = np.array([0.5, 0.2, 0.1])[:dim]
    found = force(tmp_path, body, stream)
    rounding = (1e-5 if body == "solid" else 1e-10) * np.abs(found).max()  # of the file
    for move in moves(dim):
        turned = force(tmp_path, body, move @ stream)
        np.testing.assert_allclose(turned, move @ found, atol=rounding)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_stream_along_an_axis_has_no_force_across_it(tmp_path, dim):
    along = force(tmp_path, "box", np.array([0.5, 0, 0])[:dim])
    assert np.abs(along[1:]).max() < 1e-10 * along[0]


def test_a_square_that_turns_with_its_stream(tmp_path):
    """To what six particles across resolve: the lattice of the water does not turn."""

    def velocity(stream, more=""):
        return stone(tmp_path, "box", stream, 0.21, 0.02, more)["velocity"][0]

    upright = velocity(np.array([0.5, 0]))
    for degrees in (20, 45):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        turned = velocity(0.5 * np.array([c, s]), f"rotate = {degrees}\npivot = [0, 0]\n")
        back = np.array([[c, s], [-s, c]]) @ turned
        assert back == pytest.approx(upright, abs=0.06 * upright[0])
