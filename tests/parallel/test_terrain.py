"""A terrain on several ranks: the walls and the flow of one, to rounding."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.terrain.scenes import block_in_lake, grid, profile, text

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
    felt = cKDTree(one["position"][~walls]).query(one["position"][walls])[0] < 2.78 * 0.05
    for other in others:
        flow = other["body"] != "terrain"
        assert np.array_equal(other["id"][flow], one["id"][~walls])
        np.testing.assert_allclose(other["position"][flow], one["position"][~walls], atol=1e-7)
        # What nothing feels is dropped at the next look, which rounding may put a step later.
        apart = cKDTree(other["position"][~flow]).query(one["position"][walls][felt])[0]
        assert apart.max() == 0


@pytest.mark.minutes
def test_water_under_a_block_on_two_ranks(command, tmp_path):
    """Faces of the ground on one rank and of the block on another."""
    file = block_in_lake(tmp_path)
    for ranks in (1, 2):
        arguments = ("-o", tmp_path / str(ranks), "--no-figures", "--threads", 1)
        done = command(ranks, "run", file, *arguments, "--set", "time_max=0.1")
        assert done.returncode == 0, done.stderr
    one, two = (doseki.load(tmp_path / str(ranks))[-1] for ranks in (1, 2))
    for name in ("position", "velocity", "spin"):
        np.testing.assert_allclose(two.grains[name], one.grains[name], atol=1e-7)


DAM = """
[body.dam]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [-1, 0]
min = [1.63, 0.5]
max = [1.9, 1.6]
[gauge.dam]
kind = "load"
bodies = ["dam"]
interval = 0.01
"""


@pytest.mark.minutes
def test_a_dam_in_the_ground_on_two_ranks(command, tmp_path):
    """Each rank cuts the ground at the dam: the same walls and the same load."""
    profile(tmp_path / "terrain.csv", lambda x: np.maximum(2 - 0.6 * x, 0), high=12.0)
    file = tmp_path / "case.toml"
    file.write_text(text(2, dp=0.05, time=0.1, speed=6.0, more=SLIDE + DAM))
    for ranks in (1, 2):
        arguments = ("-o", tmp_path / str(ranks), "--no-figures", "--threads", 1)
        done = command(ranks, "run", file, *arguments)
        assert done.returncode == 0, done.stderr
    one, two = (doseki.load(tmp_path / name) for name in ("1", "2"))
    assert one.gauges["dam"]["force_x"][-1] > 10
    for axis in "xy":
        force = one.gauges["dam"][f"force_{axis}"]
        np.testing.assert_allclose(two.gauges["dam"][f"force_{axis}"], force, rtol=1e-7, atol=1e-6)
    for run in (one, two):
        ground = run[-1]["position"][run[-1]["body"] == "terrain"]
        in_the_dam = (ground[:, 0] > 1.63) & (ground[:, 0] < 1.9) & (ground[:, 1] > 0.5)
        assert len(ground)
        assert not in_the_dam.any()


SLAB = """
[body.slide]
shape = "release"
material = "water"
polygon = [[14, 2], [16, 2], [16, 4], [14, 4]]
thickness = 0.5
velocity = [8, 0, -6.4]
[body.ball]
shape = "sphere"
material = "basalt"
centre = [17.5, 3.0, 17.2]
velocity = [8, 0, -6.4]
radius = 0.5
"""


@pytest.mark.minutes
def test_ranks_hold_the_part_of_the_map_that_they_need(work, tmp_path):
    """The same bits as with the whole map on each, while the parts go along with the flow."""
    grid(
        tmp_path / "terrain.asc", lambda x, y: 30 - 0.8 * x + 0.05 * (y - 3) ** 2, (80.0, 6.0), 0.2
    )
    file = tmp_path / "case.toml"
    file.write_text(text(3, dp=0.25, speed=16.0, more=SLAB))
    found = work("ground_parts", 2, str(file), "1600")
    assert found["same"]
    assert found["light"] == [False, True]
    assert found["farthest"] > 25.0
    for rank in found["ranks"]:
        assert 0 < max(rank["sizes"]) < 0.5 * found["nodes"]
        assert len(rank["sizes"]) > 1, rank
        assert len(rank["sizes"]) < 60, "it is cut anew too often"
