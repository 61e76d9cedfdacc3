"""Trust tells of water that ran back over the layers of an inflow."""

from __future__ import annotations

import pytest

from doseki.assess.trust.inflows import inflows_check
from doseki.assess.trust.verdicts import BAD, DOUBTFUL, GOOD
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario

# A trough with a sill at its end, on which water stands as high as the section.
TROUGH = """
dim = 2
scheme = "resolved"
dp = 0.01
time_max = 1.5
time_out = 0.1
gravity = [0, -9.81]
speed_max = 2

[body.water]
shape = "box"
material = "water"
min = {water[0]}
max = {water[1]}
pressure = "= 9810*(0.08 - y)"

[body.bed]
shape = "box"
material = "basalt"
fixed = true
min = {bed[0]}
max = {bed[1]}

[body.sill]
shape = "box"
material = "basalt"
fixed = true
min = {sill[0]}
max = {sill[1]}

[inflow.spring]
material = "water"
rate = 0.02
duration = 100
width = 1
position = [0, 0]
direction = [{side}, 0]
depth = 0.1
"""


def trough(side: int, height: float) -> str:
    """The flow goes along x, side = 1, or against it."""

    def box(low, high):
        x = sorted((side * low[0], side * high[0]))
        return [x[0], low[1]], [x[1], high[1]]

    return TROUGH.format(
        side=side, water=box((0, 0), (0.3, 0.08)), bed=box((-0.3, -0.04), (0.34, 0)),
        sill=box((0.3, 0), (0.34, height)),
    )  # fmt: skip


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("height", "verdicts"), [(0.25, {DOUBTFUL, BAD}), (0.02, {GOOD})])
def test_water_that_rises_above_the_layers(tmp_path, side, height, verdicts):
    (tmp_path / "trough.toml").write_text(trough(side, height), encoding="utf-8")
    run_scenario(load_scenario(str(tmp_path / "trough.toml")), tmp_path / "run")
    (check,) = inflows_check(load(tmp_path / "run"))
    assert check.verdict in verdicts
    assert check.remedy.startswith("spring: ") or check.verdict == GOOD
