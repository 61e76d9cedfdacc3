"""Water trapped between bodies holds no tension that grows with the sound speed."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows

SPEED, DIAMETER = 0.05, 0.02  # m/s at which discs part, m
TIME = 0.02  # s
# Three discs that touch and part, in water that holds a pore between them.
DISCS = f"""\
dim = 2
scheme = "resolved"
speed_max = 2
dp = "= d/16"
time_max = 1
time_out = 1
gravity = [0, 0]
uplift = false

[parameters]
d = {{ value = {DIAMETER} }}
v = {{ value = {SPEED} }}

[material.water]
cavitation_pressure = -1e9

[body.water]
shape = "box"
material = "water"
min = ["= -2*d", "= -2*d"]
max = ["= 2*d", "= 2*d"]

[body.left]
shape = "disc"
material = "basalt"
centre = ["= -d/2", "= -d/(2*sqrt(3))"]
radius = "= d/2"
velocity = ["= -v*sqrt(3)/2", "= -v/2"]

[body.right]
shape = "disc"
material = "basalt"
centre = ["= d/2", "= -d/(2*sqrt(3))"]
radius = "= d/2"
velocity = ["= v*sqrt(3)/2", "= -v/2"]

[body.top]
shape = "disc"
material = "basalt"
centre = [0, "= d/sqrt(3)"]
radius = "= d/2"
velocity = [0, "= v"]
"""


def speed_left(folder, *settings: str, times=(TIME,)) -> float:
    """Of the speed at which the discs part, what is left at these times in the mean."""
    simulation, left = Flows(folder)(DISCS, *settings), []
    for time in times:
        simulation.advance(limit=time, pause=time, max_steps=10**9)
        table = simulation.grains()
        centre, velocity = np.asarray(table["centre"]), np.asarray(table["velocity"])
        outwards = centre / np.linalg.norm(centre, axis=1)[:, None]
        left.append((velocity * outwards).sum(axis=1).mean() / SPEED)
    return float(np.mean(left))


@pytest.mark.parametrize("speed_max", [2, 8])
def test_discs_part_as_easily_at_any_sound_speed(tmp_path, speed_max):
    """An ideal liquid around them, none of it in the pore, leaves 0.78 (potential flow)."""
    assert speed_left(tmp_path, f"speed_max={speed_max}") > 0.7


@pytest.mark.parametrize("speed_max", [2, 8])
def test_suction_that_no_air_ends_holds_them(tmp_path, speed_max):
    """They go to and fro on it."""
    settings = f"speed_max={speed_max}", "material.water.air_entry_suction=1e9"
    assert speed_left(tmp_path, *settings, times=np.linspace(0.01, 0.03, 9)) < 0.3
