"""A body that breaks on several ranks, and after a restart in the middle."""

from __future__ import annotations

import shutil

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
WORDS = ("--no-figures", "--threads", 1)
MIDDLE = 0.00068  # s


@pytest.fixture(scope="module")
def pairs(command, tmp_path_factory):
    """The run on one and two ranks, and both after a stop in the middle."""
    folder = tmp_path_factory.mktemp("pair")
    (folder / "pair.toml").write_text(PAIR + CHALK)

    def do(ranks, *words):
        done = command(ranks, *words, *WORDS)
        assert done.returncode == 0, done.stderr

    for ranks in (1, 2):
        do(ranks, "run", folder / "pair.toml", "-o", folder / str(ranks))
    half = ("--set", f"time_max={MIDDLE}")
    do(1, "run", folder / "pair.toml", "-o", folder / "on 1", *half)
    shutil.copytree(folder / "on 1", folder / "on 2")
    for ranks in (1, 2):
        do(ranks, "resume", folder / f"on {ranks}", "--set", "time_max=0.00136")
    return {name: doseki.load(folder / name) for name in ("1", "2", "on 1", "on 2")}


def test_they_broke_before_and_after_the_middle(pairs):
    born = pairs["1"][-1].grains["born"]
    assert ((born > 0) & (born < MIDDLE)).any()
    assert (born > MIDDLE).any()


@pytest.mark.parametrize("other", ["2", "on 1", "on 2"])
def test_parts_are_those_of_one_rank_to_the_bit(pairs, other):
    mine, yours = pairs["1"][-1], pairs[other][-1]
    assert mine.time == yours.time
    one, two = (np.argsort(snapshot["id"]) for snapshot in (mine, yours))
    for key in ("position", "velocity", "grain"):
        assert np.array_equal(mine[key][one], yours[key][two]), key
    for key in ("mass", "parent", "born", "position", "velocity"):
        assert np.array_equal(mine.grains[key], yours.grains[key]), key
