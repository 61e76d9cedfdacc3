"""A body that breaks on several ranks, and after a restart in the middle."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import doseki

WORDS = ["--no-figures", "--threads", 1, "--set", "across=16", "--set", "speed=12"]


@pytest.fixture(scope="module")
def drops(command, tmp_path_factory):
    """The run on one and two ranks, and one that is interrupted after the first cracks."""
    folder = tmp_path_factory.mktemp("drop")
    for ranks in (1, 2):
        done = command(ranks, "run", "drop-weight", "-o", folder / str(ranks), *WORDS)
        assert done.returncode == 0, done.stderr
    end = doseki.load(folder / "1").times[-1]
    halfway = ["--set", f"time_max={end / 2!r}", "--set", f"time_out={end / 20!r}"]
    done = command(1, "run", "drop-weight", "-o", folder / "on 1", *WORDS, *halfway)
    assert done.returncode == 0, done.stderr
    shutil.copytree(folder / "on 1", folder / "on 2")
    for ranks in (1, 2):
        words = ["--no-figures", "--threads", 1, "--set", f"time_max={end!r}"]
        done = command(ranks, "resume", folder / f"on {ranks}", *words)
        assert done.returncode == 0, done.stderr
    return {name: doseki.load(folder / name) for name in ("1", "2", "on 1", "on 2")}


def test_it_broke_before_and_after_the_middle(drops):
    born = drops["1"][-1].grains["born"]
    middle = drops["1"].times[-1] / 2
    assert ((born > 0) & (born < middle)).any()
    assert (born > middle).any()


@pytest.mark.parametrize("other", ["2", "on 1", "on 2"])
def test_parts_are_those_of_one_rank_bit_for_bit(drops, other):
    mine, yours = drops["1"][-1], drops[other][-1]
    assert mine.time == yours.time
    for key in ("position", "velocity", "grain"):
        assert np.array_equal(mine[key], yours[key]), key
    for key, values in mine.grains.items():
        assert np.array_equal(values, yours.grains[key]), key
