"""A small run with everything that a checkpoint must hold, and ways to look at its record."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import doseki
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

# Water enters, meets loose rocks with strength on a fixed bed, and leaves.
CHANNEL = """\
schema = 1
title = "channel"
dim = {dim}
dp = 0.01
time_max = 0.06
time_out = 0.007
time_history = 0.0011
slope = 20
xi = 0.05
precision = "{precision}"
h_mode = "{h_mode}"
periodic = {periodic}
domain_min = {{ d2 = [-1, -1], d3 = [-1, 0, -1] }}
domain_max = {{ d2 = [1, 1], d3 = [1, "= across*dp", 1] }}

[parameters]
across = 7

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
min = {{ d2 = [0, -0.03], d3 = [0, 0, -0.03] }}
max = {{ d2 = [0.2, 0], d3 = [0.2, "= across*dp", 0] }}

[body.rocks]
shape = "box"
material = "basalt"
min = {{ d2 = [0.05, 0], d3 = [0.05, 0, 0] }}
max = {{ d2 = [0.09, 0.02], d3 = [0.09, "= across*dp", 0.02] }}
velocity = {{ d2 = [-1.5, 0], d3 = [-1.5, 0, 0] }}

[inflow.water]
material = "water"
rate = {{ d2 = 0.003, d3 = 0.0021 }}
width = {{ d2 = 0.1, d3 = "= across*dp" }}
position = {{ d2 = [0.15, 0], d3 = [0.15, 0, 0] }}
direction = {{ d2 = [-1, 0], d3 = [-1, 0, 0] }}
depth = 0.03
start = 0.004
duration = 0.04

[outflow.end]
min = {{ d2 = ["-inf", "-inf"], d3 = ["-inf", "-inf", "-inf"] }}
max = {{ d2 = [0.03, "inf"], d3 = [0.03, "inf", "inf"] }}
"""


def channel_text(dim: int = 2, precision: str = "double", h_mode: str = "constant") -> str:
    """The scenario file; in 3-D it is periodic across."""
    periodic = '["y"]' if dim == 3 else "[]"
    return CHANNEL.format(dim=dim, precision=precision, h_mode=h_mode, periodic=periodic)


def run_channel(file: Path, directory: Path, *settings: str, **options: object) -> dict:
    """Run the scenario of `file` on one thread, in this process."""
    scenario = load_scenario(file, settings)
    return run_scenario(scenario, directory, RunOptions(**{"threads": 1} | options))


def record(directory: Path) -> dict[str, bytes]:
    """What a run recorded: contents of its snapshots and history by file name."""
    files = [directory / "history.csv", directory / "snapshots.vtkhdf.series"]
    files += sorted((directory / "snapshots").iterdir())
    return {file.name: file.read_bytes() for file in files}


def assert_same_record(directory: Path, expected: Path) -> None:
    """Every snapshot and history row of two runs agree to the last bit."""
    one, other = record(directory), record(expected)
    assert list(one) == list(other)
    for name, content in other.items():
        assert one[name] == content, name


def command(*arguments: object) -> list[str]:
    """The command line of doseki in a process of its own."""
    return [sys.executable, "-m", "doseki.cli.main", *map(str, arguments)]


def environment() -> dict[str, str]:
    """The environment in which `command` finds this doseki."""
    packages = str(Path(doseki.__file__).parents[1])
    paths = [packages, *filter(None, [os.environ.get("PYTHONPATH")])]
    return os.environ | {"PYTHONPATH": os.pathsep.join(paths)}


def doseki_command(*arguments: object, **options: object) -> subprocess.CompletedProcess[str]:
    """Run doseki in a process of its own and wait for it."""
    options = {"capture_output": True, "text": True, "check": False} | options
    return subprocess.run(command(*arguments), **{"env": environment()} | options)
