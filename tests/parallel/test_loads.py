"""Loads on structures that span ranks."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import doseki

from ..loads.scenes import RAIN

GAUGES = ("all", "sill", "top", "crest")


@pytest.fixture(scope="module")
def rain(command, tmp_path_factory):
    """The runs on one and two ranks, and one that goes on on two."""
    folder = tmp_path_factory.mktemp("rain")
    file = folder / "rain.toml"
    file.write_text(RAIN)
    words = ["--no-figures", "--threads", 1, "--set", "time_out=0.03"]
    for ranks in (1, 2):
        more = ["--set", "time_max=0.06"]
        done = command(ranks, "run", file, "-o", folder / str(ranks), *words, *more)
        assert done.returncode == 0, done.stderr
    done = command(1, "run", file, "-o", folder / "first", *words, "--set", "time_max=0.03")
    assert done.returncode == 0, done.stderr
    shutil.copytree(folder / "first", folder / "on 2")
    words = ["--no-figures", "--threads", 1, "--set", "time_max=0.06"]
    done = command(2, "resume", folder / "on 2", *words)
    assert done.returncode == 0, done.stderr
    return {name: doseki.load(folder / name) for name in ("1", "2", "on 2")}


@pytest.mark.parametrize("ranks", ["2", "on 2"])
def test_gauges_of_loads_read_as_on_one_rank(rain, ranks):
    """To rounding, which collisions of grains magnify."""
    for name in GAUGES:
        one, two = rain["1"].gauges[name], rain[ranks].gauges[name]
        assert len(one["time"]) > 5
        for column in one:
            scale = np.nanmax(np.abs(one[column]), initial=0.0)
            np.testing.assert_allclose(two[column], one[column], atol=1e-6 * scale, err_msg=column)
    assert np.nanmax(np.abs(rain["1"].gauges["sill"]["contact_force_y"])) > 0
