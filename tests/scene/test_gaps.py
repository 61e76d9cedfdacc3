"""Narrow gaps beside bodies under deep water, where their uplift is rough, are told of."""

from __future__ import annotations

import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.checks.bodies.gaps import NarrowGap
from doseki.solver.build import filled_simulation

TANK = """
schema = 1
dim = {dim}
dp = {dp}
scheme = "resolved"
speed_max = 2
time_max = 0.1
time_out = 0.1
gravity = {gravity}
{top}

[body.tank]
shape = "tank"
material = "basalt"
min = {lowest}
max = {highest}

[body.water]
shape = "box"
material = "water"
min = {lowest}
max = {surface}
"""
BLOCK = """
[body.block_{number}]
shape = "box"
material = "basalt"
min = {low}
max = {high}
"""


def corner(dim: int, x: float, up: float, across: float = 0.1) -> str:
    return f"[{x:.6g}, {up:.6g}]" if dim == 2 else f"[{x:.6g}, {across:.6g}, {up:.6g}]"


def gaps(
    folder, *, gap=0.5, head=1.2, up=0.0, top="", gravity="", dim=2, dp=0.01, place=0.2, wet=0.9
) -> list[NarrowGap]:
    """The findings about two blocks of 0.1 m side by side, `gap` spacings apart."""
    text = TANK.format(
        dim=dim, dp=dp, top=top, gravity=gravity or corner(dim, 0, -9.81, 0),
        lowest=corner(dim, 0, 0, 0), highest=corner(dim, 0.9, 2, 0.3),
        surface=corner(dim, wet, head, 0.3),
    )  # fmt: skip
    for number, x in enumerate((place, place + 0.1 + gap * dp)):
        low, high = corner(dim, x, number * up), corner(dim, x + 0.1, number * up + 0.1, 0.2)
        text += BLOCK.format(number=number, low=low, high=high)
    (folder / "case.toml").write_text(text)
    _, _, warnings = filled_simulation(load_scenario(str(folder / "case.toml")))
    return [finding for finding in warnings if isinstance(finding, NarrowGap)]


def test_each_of_the_two_is_told_of(tmp_path):
    one, other = gaps(tmp_path)
    assert (one.place, one.other) == ("body.block_0", "block_1")
    assert (other.place, other.other) == ("body.block_1", "block_0")
    assert one.gap == pytest.approx(0.005)
    assert "0.5 dp: under 1.2 m of water" in str(one)
    assert "wrong by 84 %; let them touch, leave a gap of a dp, or take a smaller dp" in str(one)


def test_to_a_wall_as_well(tmp_path):
    (finding,) = gaps(tmp_path, gap=5, place=0.005)
    assert "tank" in finding.other


def test_in_space(tmp_path):
    found = gaps(tmp_path, dim=3, dp=0.02, head=0.6)
    assert found[0].error == pytest.approx(0.84, abs=0.01)


@pytest.mark.parametrize(
    "given",
    [
        {"gap": 0},
        {"gap": 0.1},
        {"gap": 1},
        {"gap": 5},
        {"up": 0.4},
        {"head": 0.3, "dp": 0.005},
        {"top": "uplift = false"},
        {"gravity": "[0, 0]"},
        {"gravity": "[9.81, 0]"},
        {"place": 0.6, "wet": 0.3},
    ],
)
def test_others_are_not(tmp_path, given):
    assert gaps(tmp_path, **given) == []
