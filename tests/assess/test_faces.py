"""What the trust report says of fluid at sides of a body that its `normal` makes no wall."""

from __future__ import annotations

import pytest

from doseki.assess.trust.faces import faces_check
from doseki.assess.trust.verdicts import BAD, GOOD

from .accounts import recorded

DAM = """
scheme = "resolved"
speed_max = 3.0
dim = 2
dp = 0.05
gravity = [0, -9.81]
time_max = 0.01
time_out = 0.005

[body.left]
shape = "box"
material = "water"
min = [0.0, 0.0]
max = [0.4, 0.6]
rotate = {turn}
pivot = [0.0, 0.0]

[body.dam]
shape = "box"
material = "basalt"
fixed = true
min = [0.4, 0.0]
max = [0.6, 0.8]
rotate = {turn}
pivot = [0.0, 0.0]
{normal}
"""


BEHIND = """
[body.right]
shape = "box"
material = "water"
min = [0.6, 0.0]
max = [1.0, 0.4]
rotate = {turn}
pivot = [0.0, 0.0]
"""


def checks_of(folder, text=DAM + BEHIND, turn=0.0, normal="normal = [-1, 0]"):
    return faces_check(recorded(folder, text.format(turn=turn, normal=normal)))


@pytest.mark.parametrize("turn", [0.0, 25.0, 180.0])
def test_water_behind_a_dam_of_one_face_is_told_with_its_name(tmp_path, turn):
    (check,) = checks_of(tmp_path, turn=turn)
    assert check.value == pytest.approx(8 / (12 + 8), abs=0.01)
    assert check.verdict == BAD
    assert "dam" in check.remedy
    assert "leave it out" in check.remedy


@pytest.mark.parametrize("motion", ["", "[body.dam.motion]\nvelocity = [5, 0]"])
def test_water_on_its_face_alone_is_good(tmp_path, motion):
    """Also where the face has gone two spacings away from where it was."""
    (check,) = checks_of(tmp_path, DAM + motion)
    assert check.value == 0
    assert check.verdict == GOOD


def test_walls_without_a_normal_are_not_looked_at(tmp_path):
    assert checks_of(tmp_path, normal="") == []
