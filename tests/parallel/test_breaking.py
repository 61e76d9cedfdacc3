"""A body that breaks on several ranks, and after a restart in the middle."""

from __future__ import annotations

import shutil
import tomllib

import numpy as np
import pytest

import doseki

from ..small_scenarios import CHALK

PAIR = """
schema = 1
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 6
time_max = 0.00136
time_out = 0.00034
gravity = [0, 0]

[body.a]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [-0.0505, 0.01]
radius = 0.05
velocity = [6, 0]

[body.b]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [0.0505, -0.01]
radius = 0.05
velocity = [-6, 0]
"""
IN_SPACE = """
schema = 1
dim = 3
dp = 0.0125
scheme = "resolved"
speed_max = 10
time_max = 0.002
time_out = 0.001
gravity = [0, 0, 0]

[body.a]
shape = "sphere"
material = "chalk"
kinematics = "elastic"
centre = [-0.0505, 0.01, 0]
radius = 0.05
velocity = [9, 0, 0]

[body.b]
shape = "sphere"
material = "chalk"
kinematics = "elastic"
centre = [0.0505, -0.01, 0]
radius = 0.05
velocity = [-9, 0, 0]
"""
WORDS = ("--no-figures", "--threads", 1)


RIGID_FIRST = PAIR.replace('"elastic"', '"breakable"')
IN_SPACE_RIGID_FIRST = IN_SPACE.replace('"elastic"', '"breakable"')


@pytest.fixture(
    scope="module",
    params=[
        PAIR,
        RIGID_FIRST,
        pytest.param(IN_SPACE, marks=pytest.mark.ranks),
        pytest.param(IN_SPACE_RIGID_FIRST, marks=pytest.mark.ranks),
    ],
    ids=["2-D", "2-D, rigid first", "3-D", "3-D, rigid first"],
)
def pairs(command, tmp_path_factory, request):
    """The run on one and two ranks, and both after a stop in the middle."""
    folder = tmp_path_factory.mktemp("pair")
    (folder / "pair.toml").write_text(request.param + CHALK)
    end = tomllib.loads(request.param)["time_max"]

    def do(ranks, *words):
        done = command(ranks, *words, *WORDS)
        assert done.returncode == 0, done.stderr

    for ranks in (1, 2):
        do(ranks, "run", folder / "pair.toml", "-o", folder / str(ranks))
    half = ("--set", f"time_max={end / 2}")
    do(1, "run", folder / "pair.toml", "-o", folder / "on 1", *half)
    shutil.copytree(folder / "on 1", folder / "on 2")
    for ranks in (1, 2):
        do(ranks, "resume", folder / f"on {ranks}", "--set", f"time_max={end}")
    return {name: doseki.load(folder / name) for name in ("1", "2", "on 1", "on 2")}


def test_they_broke_before_and_after_the_middle(pairs):
    born, middle = pairs["1"][-1].grains["born"], pairs["1"][-1].time / 2
    assert ((born > 0) & (born < middle)).any()
    assert (born > middle).any()


@pytest.mark.parametrize("other", ["2", "on 1", "on 2"])
def test_parts_are_those_of_one_rank_to_the_bit(pairs, other):
    mine, yours = pairs["1"][-1], pairs[other][-1]
    assert mine.time == yours.time
    one, two = (np.argsort(snapshot["id"]) for snapshot in (mine, yours))
    for key in ("position", "velocity", "grain"):
        assert np.array_equal(mine[key][one], yours[key][two]), key
    for key in ("mass", "parent", "born", "position", "velocity"):
        assert np.array_equal(mine.grains[key], yours.grains[key]), key
