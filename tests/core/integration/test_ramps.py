"""A stream without friction climbs a ramp and keeps its energy, however its wall was given."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows

STREAM = """\
dim = 2
scheme = "resolved"
speed_max = 5
dp = 0.02
time_max = 1
time_out = 1
gravity = [0, -9.81]

[body.stream]
shape = "box"
material = "water"
min = [{low}, 0]
max = [{high}, 0.1]
velocity = [{speed}, 0]
"""
WALL = '\n[body.{}]\nmaterial = "aluminium"\nfixed = true\nwall = "free_slip"\n{}\n'
RAMPS = {
    "polygon with a level foot": [[0.5, -0.2], [3.5, -0.2], [3.5, 0.3], [0.5, 0]],
    "polygon along the slope": [[0.5, -0.2], [3.5, 0.1], [3.5, 0.3], [0.5, 0]],
    "polygon that thins to nothing on the bed": [[0.5, 0], [3.5, 0], [3.5, 0.3]],
}


def scene(ramp: str, mirrored: bool) -> str:
    """A stream at 4 m/s on a level bed before a ramp of 1 : 10."""
    low, high = (-0.7, 0.3)
    end, speed = (3.6 if "thins" in ramp else 0.5), 4.0
    corners = [[-x if mirrored else x, y] for x, y in RAMPS[ramp]]
    left, right = (-end, 2.0) if mirrored else (-2.0, end)
    if mirrored:
        low, high, speed = -high, -low, -speed
    bed = f'shape = "box"\nmin = [{left}, -0.2]\nmax = [{right}, 0]'
    slope = f'shape = "polygon"\nvertices = {corners}'
    text = STREAM.format(low=low, high=high, speed=speed)
    return text + WALL.format("bed", bed) + WALL.format("ramp", slope)


def energy(simulation) -> float:
    """Of motion and of height, J/m."""
    state = simulation.state()
    moving = np.asarray(state["motion"]) == 0
    mass, speed = state["mass"][moving], np.linalg.norm(state["velocity"][moving], axis=1)
    return float(mass @ (0.5 * speed**2 + 9.81 * state["position"][moving, 1]))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("ramp", RAMPS)
def test_a_ramp_takes_no_energy(tmp_path, ramp, mirrored):
    """Where its particles lay in stairs below it, it took 13 % by then."""
    simulation = Flows(tmp_path)(scene(ramp, mirrored))
    before = energy(simulation)
    simulation.advance(limit=0.5, pause=0.5, max_steps=10**6)
    state = simulation.state()
    x = state["position"][np.asarray(state["motion"]) == 0, 0]
    assert np.abs(x).max() > 2.0  # all of it is on the ramp
    assert np.abs(x).min() > 0.5
    assert energy(simulation) > 0.99 * before
