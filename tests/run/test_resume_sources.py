"""Hydrographs, moving walls, gates, gauges: resumed to the same bits, no row twice or missing."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.figures.plot import plot_run
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import assert_same_record, channel_text, run_channel
from .test_resume import stop_at

EXTRA = """
[body.gate]
shape = "box"
material = "aluminium"
fixed = true
min = { d2 = [0.1, 0], d3 = [0.1, 0, 0] }
max = { d2 = [0.13, 0.05], d3 = [0.13, "= across*dp", 0.05] }
motion.velocity = { d2 = [0.2, 0.3], d3 = [0.2, 0, 0.3] }
motion.angular_velocity = { d2 = 4, d3 = [0, -4, 0] }
motion.pivot = { d2 = [0.1, 0], d3 = [0.1, 0, 0] }
motion.start = 0.003
motion.stop = 0.021
motion.removed_at = 0.0333

[gauge.depth]
kind = "surface_height"
position = { d2 = [0.14, 0], d3 = [0.14, 0.03, 0] }
direction = { d2 = [0, 1], d3 = [0, 0, 1] }
interval = 0.0013

[gauge.profile]
kind = "velocity_profile"
position = { d2 = [0.07, 0], d3 = [0.07, 0.03, 0] }
length = 0.03
count = 3
interval = 0.01

[gauge.weir]
kind = "discharge"
position = { d2 = [0.14, 0], d3 = [0.14, 0, 0] }
direction = { d2 = [-1, 0], d3 = [-1, 0, 0] }
interval = 0.0021

[gauge.toe]
kind = "pressure"
position = { d2 = [0.07, 0], d3 = [0.07, 0.03, 0] }

[gauge.tap]
kind = "pressure"
position = { d2 = [0.05, 0], d3 = [0.05, 0.03, 0] }
filter_hz = 200
interval = 0.0021

[figure.depth]
kind = "gauge"
gauge = "depth"

[figure.profile]
kind = "gauge"
gauge = "profile"
columns = ["velocity_x"]
"""
NAMES = ("depth", "profile", "tap", "toe", "weir")


def text(dim=2):
    """The channel with a hydrograph in place of its rate, and all that moves or measures."""
    rate = "rate = { d2 = 0.003, d3 = 0.0021 }\n"
    hydrograph = "hydrograph = [[0, 0], [0.01, 0.003], [0.02, 0.003], [0.04, 0.001]]\n"
    if dim == 3:
        hydrograph = hydrograph.replace("0.003", "0.0021").replace("0.001]", "0.0007]")
    whole = channel_text(dim)
    assert rate in whole
    return whole.replace(rate, hydrograph).replace("duration = 0.04\n", "") + EXTRA


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """The scenario file and the folder of a run of it without a break."""
    folder = tmp_path_factory.mktemp("sources")
    (folder / "case.toml").write_text(text())
    run_channel(folder / "case.toml", folder / "straight")
    return folder / "case.toml", folder / "straight"


def assert_same_gauges(one, other):
    for name in NAMES:
        file = f"gauges/{name}.csv"
        assert (one / file).read_bytes() == (other / file).read_bytes(), name


def broken(file, directory, times):
    """Run with stops at `times`, from a checkpoint a little before each."""
    options = {"checkpoint_every": 0.001}
    run_channel(file, directory, progress=stop_at(directory, times[0]), **options)
    for time in times[1:]:
        progress = stop_at(directory, time)
        resume_run(directory, (), RunOptions(1, progress=progress, **options))
    resume_run(directory, (), RunOptions(threads=1))


def test_resumed_to_the_same_bits(case, tmp_path):
    file, straight = case
    broken(file, tmp_path / "run", (0.0041, 0.0152, 0.0334, 0.045))
    assert_same_record(tmp_path / "run", straight)
    assert_same_gauges(tmp_path / "run", straight)


@pytest.mark.minutes
def test_resumed_to_the_same_bits_in_3d(tmp_path):
    (tmp_path / "case.toml").write_text(text(3))
    run_channel(tmp_path / "case.toml", tmp_path / "straight")
    broken(tmp_path / "case.toml", tmp_path / "run", (0.0152, 0.0334))
    assert_same_record(tmp_path / "run", tmp_path / "straight")
    assert_same_gauges(tmp_path / "run", tmp_path / "straight")


def test_rows_after_the_checkpoint_are_dropped(case, tmp_path):
    """A kill leaves rows that the last checkpoint does not know, and half a row."""
    file, straight = case
    run_channel(file, tmp_path / "run", progress=stop_at(tmp_path / "run", 0.02))
    rows = (straight / "gauges/depth.csv").read_text().splitlines(keepends=True)
    known = (tmp_path / "run/gauges/depth.csv").read_text()
    (tmp_path / "run/gauges/depth.csv").write_text(known + "".join(rows[-3:]) + "0.05")
    resume_run(tmp_path / "run", (), RunOptions(threads=1))
    assert_same_gauges(tmp_path / "run", straight)


def test_samples_are_at_their_times_exactly(case):
    run = load(case[1])
    assert tuple(run.gauges) == NAMES
    steps = {"depth": 0.0013, "profile": 0.01, "weir": 0.0021, "toe": 0.007, "tap": 0.0021}
    for name, interval in steps.items():
        times = np.unique(run.gauges[name]["time"])
        expected = np.arange(int(0.06 / interval * (1 + 1e-9)) + 1) * interval
        if expected[-1] < 0.06 * (1 - 1e-9):
            expected = np.append(expected, 0.06)
        np.testing.assert_allclose(times, expected, rtol=1e-12, err_msg=name)
    assert len(run.gauges["profile"]["time"]) == 3 * 7
    assert run.gauges["weir"].units == {"time": "s", "discharge": "m2/s", "mass_rate": "kg/s/m"}
    with pytest.raises(KeyError, match="is not a column; did you mean height"):
        run.gauges["depth"]["heigth"]


def test_gauges_see_the_flow(case):
    """Dry at first, then the inflow's three layers of particles come to 0.14 m."""
    depth = load(case[1]).gauges["depth"]
    assert depth["height"][0] == 0
    assert 0.015 < depth["height"].max() < 0.05


def test_the_gate_moved_and_vanished(case):
    run = load(case[1])
    first, moved, still = run[0], run.at(0.014), run.at(0.028)
    gate = first["body"] == "gate"
    assert gate.sum() == 15
    shift = moved["position"][moved["body"] == "gate"] - first["position"][gate]
    assert (np.abs(shift) > 1e-3).all(axis=1).any()
    assert (still["velocity"][still["body"] == "gate"] == 0).all()
    assert not np.any(run.at(0.035)["body"] == "gate")


def test_the_ledger_closes_with_a_hydrograph(case):
    run = load(case[1])
    asked = 1000 / 0.1 * (0.5 * 0.003 * 0.01 + 0.003 * 0.01 + 0.002 * 0.02)
    assert run.summary["mass_asked"] == pytest.approx(asked, rel=1e-9)
    layer = 3 * 1000 * 0.01**2
    assert abs(run.summary["mass_entered"] - asked) <= 0.5 * layer * (1 + 1e-9)
    assert abs(run.summary["ledger_residual"]) < 1e-9


def test_gauges_are_drawn(case):
    names = {path.stem for path in plot_run(case[1])}
    assert {"depth", "profile"} <= names


def test_an_overwritten_run_leaves_no_gauge_behind(case, tmp_path, channel_file):
    file, _ = case
    run_channel(file, tmp_path / "run", "time_max=0.002")
    run_channel(channel_file, tmp_path / "run", "time_max=0.002", overwrite=True)
    assert not list((tmp_path / "run/gauges").glob("*.csv"))
