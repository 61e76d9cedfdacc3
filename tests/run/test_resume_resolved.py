"""A run of the resolved scheme that was interrupted leaves the record of one that was not."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import assert_same_record, doseki_command, run_channel
from .test_resume import stop_at

# Water enters over a rough bed, meets a pool before a block, and leaves; a force gauge stands by.
FLOW = """\
dim = 2
scheme = "resolved"
speed_max = 3
dp = 0.01
time_max = 0.06
time_out = 0.007
time_history = 0.0011
slope = 10
turbulence = "mixing_length"

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.01
normal = [0, 1]
min = [-0.15, -0.03]
max = [0.35, 0]

[body.block]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.1, 0]
max = [0, 0.06]

[body.pool]
shape = "box"
material = "water"
min = [0, 0]
max = [0.1, 0.05]
jitter = 0.1

[inflow.water]
material = "water"
rate = 0.01
width = 0.1
position = [0.2, 0]
direction = [-1, 0]
depth = 0.05
start = 0.004
duration = 0.04

[outflow.end]
min = ["-inf", "-inf"]
max = [-0.12, "inf"]

[gauge.block]
kind = "force"
bodies = ["block"]
interval = 0.0013
"""
INTERRUPTIONS = (0.0101, 0.0207, 0.0209, 0.0455)


@pytest.fixture(scope="module")
def flow_file(tmp_path_factory):
    """The scenario file."""
    file = tmp_path_factory.mktemp("flow") / "flow.toml"
    file.write_text(FLOW)
    return file


@pytest.fixture(scope="module")
def straight(flow_file):
    """The folder of a run from beginning to end."""
    run_channel(flow_file, flow_file.parent / "straight")
    return flow_file.parent / "straight"


def test_stop_and_resume(flow_file, straight, tmp_path):
    options = {"checkpoint_every": 0.001}
    run = tmp_path / "run"
    summary = run_channel(flow_file, run, progress=stop_at(run, INTERRUPTIONS[0]), **options)
    for time in INTERRUPTIONS[1:]:
        assert summary["status"] == "stopped"
        summary, _ = resume_run(run, (), RunOptions(1, progress=stop_at(run, time), **options))
    assert summary["status"] == "stopped"
    assert resume_run(run, (), RunOptions(threads=1))[0]["status"] == "done"
    assert_same_record(run, straight)
    gauges = [sorted((folder / "gauges").iterdir()) for folder in (run, straight)]
    assert [file.read_bytes() for file in gauges[0]] == [file.read_bytes() for file in gauges[1]]


def test_resume_on_the_command_line(flow_file, straight, tmp_path):
    run_channel(flow_file, tmp_path / "run", progress=stop_at(tmp_path / "run", 0.02))
    done = doseki_command("resume", tmp_path / "run", "--threads", 1)
    said = [line for line in done.stderr.splitlines() if "cores are not" not in line]
    assert (done.returncode, said) == (0, [])
    assert_same_record(tmp_path / "run", straight)


def test_the_run_is_one_worth_resuming(straight):
    """Water has entered, met the pool, and the walls feel it."""
    run = load(straight)
    assert run.summary["mass_entered"] > 0
    assert run.summary["neighbour_rebuilds"] > 3
    speed = np.linalg.norm(run[-1]["velocity"], axis=1)
    assert speed.max() > 0.3
