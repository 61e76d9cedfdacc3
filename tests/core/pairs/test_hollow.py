"""Neighbours where most of a box is empty."""

from __future__ import annotations

import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

FRAME = """\
dim = 2
scheme = "resolved"
speed_max = 1
dp = 0.01
time_max = 1
time_out = 1
skin = 0.1

[parameters]
half = {{ value = {half}, unit = "m" }}

[body.frame]
shape = "box"
material = "water"
min = ["= -half", "= -half"]
max = ["= half", "= half"]
where = "= max(abs(x), abs(y)) - half + 0.03"
"""


def entries(tmp_path, half):
    """Of the lists for a particle, of a frame that is three particles thick."""
    file = tmp_path / "frame.toml"
    file.write_text(FRAME.format(half=half))
    simulation, _ = build_simulation(load_scenario(str(file), []))
    return simulation.entries_per_particle


def test_what_lies_far_apart_shares_no_list(core, tmp_path):
    assert entries(tmp_path, 1.5) == pytest.approx(entries(tmp_path, 0.3), rel=0.1)
