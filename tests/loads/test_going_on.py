"""Loads of a run that starts from another one, and of a wall that moves."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from .scenes import RAIN, run_of

GATE = """\
dim = 2
dp = 0.02
time_max = 0.06
time_out = 0.06
scheme = "resolved"
speed_max = 2
gravity = [0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
normal = [0, 1]
min = [-0.06, -0.06]
max = [0.6, 0]

[body.gate]
shape = "box"
material = "aluminium"
fixed = true
min = [0.4, 0]
max = [0.46, 0.4]
normal = [-1, 0]
motion = { velocity = [0.5, 0], removed_at = 0.05 }

[body.back]
shape = "box"
material = "aluminium"
fixed = true
normal = [1, 0]
min = [-0.06, 0]
max = [0, 0.4]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.2]
pressure = "= 9800*(0.2 - y)"

[gauge.load]
kind = "load"
bodies = ["gate"]
interval = 0.0005

[gauge.force]
kind = "force"
bodies = ["gate"]
interval = 0.0005
"""


def test_a_run_from_a_checkpoint_sums_from_zero(tmp_path):
    """Other gauges do not matter: rows after the start are those of the run that went through. What
    presses on panels before the first step is not known: their first row is so but for that.
    """
    whole = run_of(tmp_path, RAIN)
    (tmp_path / "first").mkdir()
    run_of(tmp_path / "first", RAIN, "time_max=0.12")
    text = RAIN.replace("[gauge.rare]", "[gauge.another]") + '[start]\nfrom = "first/run"\n'
    (tmp_path / "second.toml").write_text(text)
    run_scenario(load_scenario(str(tmp_path / "second.toml")), tmp_path / "second", RunOptions(1))
    for name in ("sill", "top"):
        old, new = whole.gauges[name], load(tmp_path / "second").gauges[name]
        first = new["time"] == 0.12
        late = old["time"] > 0.12
        for column in old:
            if column == "time" or column.startswith(("along", "panel")):
                continue
            after, through = new[column][~first], old[column][late]
            rows = 4 if name == "top" else 0  # of the first sample, one for each panel
            np.testing.assert_allclose(after[:rows], through[:rows], rtol=0.05, atol=1e-7)
            np.testing.assert_allclose(
                after[rows:], through[rows:], rtol=1e-9, atol=1e-7, err_msg=column
            )


def test_a_gate_that_is_pushed_away_and_vanishes(tmp_path):
    """Means of impulses against the mean of instants, closely spaced; nothing once it is gone."""
    gauges = run_of(tmp_path, GATE).gauges
    mean, instant = gauges["load"], gauges["force"]
    there = mean["time"][1:] < 0.0495
    middle = 0.5 * (instant["force_x"][1:] + instant["force_x"][:-1])
    difference = (mean["force_x"][1:] - middle)[there]
    assert np.abs(difference).mean() < 0.02 * np.abs(middle[there]).mean()
    gone = mean["time"] > 0.0515
    for column in ("force_x", "static_force_x", "dynamic_force_x"):
        assert not mean[column][gone].any()
    assert mean["static_force_x"][1] == pytest.approx(0.5 * 9800 * 0.2**2, rel=0.05)
