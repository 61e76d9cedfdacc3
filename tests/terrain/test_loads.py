"""Loads of a wall on a terrain: moments and panels do not depend on where the map lies."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario

from .scenes import profile, text

DAM = """
[body.lake]
shape = "box"
material = "water"
min = [{x0}, {y0}]
max = [{x1}, {y1}]
[body.dam]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [-1, 0]
min = [{x1}, {low}]
max = [{x2}, {top}]
[gauge.dam]
kind = "load"
bodies = ["dam"]
about = [{x1}, {y0}]
interval = 0.02
[gauge.face]
kind = "panels"
bodies = ["dam"]
origin = [{x1}, {y0}]
edges = [[0, 0.6]]
panels = [2]
direction = [-1, 0]
interval = 0.02
"""


@pytest.mark.parametrize("shift", [(2048.0, 1024.0), (460800.0, 2048.0)])
def test_moments_and_panels_are_those_of_the_same_wall_at_zero(tmp_path, shift):
    records = []
    for at in ((0.0, 0.0), shift):
        profile(tmp_path / "terrain.csv", lambda x: 0 * x, 0.0, 4.0, 1 / 16, at)
        places = {"x0": 1.0, "x1": 2.0, "x2": 2.5}
        heights = {"y0": 0.0, "y1": 0.5, "low": -0.1875, "top": 0.75}
        values = {k: v + at[0] for k, v in places.items()}
        values |= {k: v + at[1] for k, v in heights.items()}
        path = tmp_path / "case.toml"
        path.write_text(text(2, dp=0.0625, time=0.1, speed=4.0, more=DAM.format(**values)))
        scenario = load_scenario(path, ["terrain.resample=0.0625"])
        folder = tmp_path / f"run{len(records)}"
        run_scenario(scenario, folder)
        records.append(load(folder).gauges)
    near, far = records
    assert np.abs(near["dam"]["moment"][-1]) > 10
    for gauge in ("dam", "face"):
        for column in near[gauge]:
            assert far[gauge][column] == pytest.approx(near[gauge][column], abs=1e-3, nan_ok=True)
