"""Gaps between upright faces that are a part of a spacing wide are told of."""

from __future__ import annotations

import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.checks.bodies.gaps import NarrowGap
from doseki.solver.build import filled_simulation

TANK = """
schema = 1
dim = 2
dp = 0.01
scheme = "resolved"
speed_max = 2
time_max = 0.1
time_out = 0.1
gravity = {gravity}
{top}

[body.tank]
shape = "tank"
material = "basalt"
min = [0, 0]
max = [1, 0.6]

[body.water]
shape = "box"
material = "{liquid}"
min = [0, 0]
max = [1, 0.3]

[body.first]
shape = "box"
material = "basalt"
min = [{place}, 0]
max = [{place} + 0.1, 0.1]
rotate = {rotate}

[body.second]
shape = "box"
material = "basalt"
min = [{place} + 0.1 + {gap}, {up}]
max = [{place} + 0.2 + {gap}, {up} + 0.1]
"""


def gaps(folder, *, gap=0.5, place=0.3, up=0.0, top="", gravity="[0, -9.81]", rotate=0):
    """The findings about two blocks `gap` spacings apart, m else."""
    text = TANK.replace("{place} + 0.1 + {gap}", str(place + 0.1 + 0.01 * gap))
    text = text.replace("{place} + 0.2 + {gap}", str(place + 0.2 + 0.01 * gap))
    text = text.replace("{place} + 0.1,", f"{place + 0.1},").replace("{up} + 0.1", str(up + 0.1))
    text = text.format(place=place, up=up, top=top, gravity=gravity, rotate=rotate, liquid="water")
    (folder / "case.toml").write_text(text)
    _, _, warnings = filled_simulation(load_scenario(str(folder / "case.toml")))
    return [finding for finding in warnings if isinstance(finding, NarrowGap)]


def test_a_gap_of_half_a_spacing_is_told_of(tmp_path):
    (finding,) = gaps(tmp_path)
    assert finding.gap == pytest.approx(0.005)
    assert "body.first" in str(finding)
    assert "0.5 dp" in str(finding)
    assert "let them touch, or leave a gap of a dp" in str(finding)


def test_to_a_wall_as_well(tmp_path):
    (finding,) = gaps(tmp_path, gap=5, place=0.005)
    assert "tank" in finding.other


@pytest.mark.parametrize(
    "given",
    [
        {"gap": 0},
        {"gap": 0.1},
        {"gap": 1},
        {"gap": 5},
        {"up": 0.4},
        {"rotate": 30},
        {"top": "uplift = false"},
        {"gravity": "[0, 0]"},
        {"gravity": "[9.81, 0]"},
    ],
)
def test_other_gaps_are_not(tmp_path, given):
    assert gaps(tmp_path, **given) == []
