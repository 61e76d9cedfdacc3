"""A terrain on several ranks: the walls and the flow of one, to rounding."""

from __future__ import annotations

import numpy as np
import pytest
from tests.terrain.scenes import profile, text

import doseki

SLIDE = """
[body.slide]
shape = "release"
material = "water"
between = [0.5, 1.5]
thickness = 0.3
"""


@pytest.mark.minutes
def test_a_slide_on_two_ranks(command, tmp_path):
    """Stopped and gone on with on two ranks as well."""
    profile(tmp_path / "terrain.csv", lambda x: np.maximum(2 - 0.6 * x, 0), high=12.0)
    file = tmp_path / "case.toml"
    file.write_text(text(2, dp=0.05, time=0.1, speed=6.0, more=SLIDE))

    def run(ranks, folder, *more):
        arguments = ("-o", folder, "--no-figures", "--threads", 1, "--set", "time_out=0.05", *more)
        done = command(ranks, "run", file, *arguments)
        assert done.returncode == 0, done.stderr

    run(1, tmp_path / "one")
    run(2, tmp_path / "two")
    run(2, tmp_path / "both", "--set", "time_max=0.05")
    more = ("--no-figures", "--threads", 1, "--set", "time_max=0.1")
    assert command(2, "resume", tmp_path / "both", *more).returncode == 0
    one, *others = (doseki.load(tmp_path / name)[-1] for name in ("one", "two", "both"))
    walls = one["body"] == "terrain"
    for other in others:
        assert np.array_equal(other["id"], one["id"])
        assert np.array_equal(other["position"][walls], one["position"][walls])
        np.testing.assert_allclose(other["position"], one["position"], atol=1e-7)
