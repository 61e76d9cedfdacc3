"""A study of runs that take a moment: a block of water falls freely."""

from __future__ import annotations

from pathlib import Path

SCENARIO = """\
dim = 2
dp = 0.1
time_max = 0.02
time_out = 0.01
gravity = [0, "= -pull"]
scheme = "resolved"
speed_max = 1

[parameters]
pull = { value = 9.81, unit = "m/s2" }

[body.block]
shape = "box"
material = "water"
min = [0, 0]
max = [0.6, 0.3]

[gauge.centre]
kind = "mass_centre"
interval = 0.01
"""
STUDY = """\
scenario = "./fall.toml"

[vary.pull]
values = [5, 10, 20]

[sample]
kind = "grid"

[result.speed]
kind = "gauge"
gauge = "centre"
column = "velocity_y"
"""


def write_study(folder: Path, text: str = STUDY, scenario: str = SCENARIO) -> Path:
    """A study file with its scenario beside it."""
    (folder / "fall.toml").write_text(scenario, encoding="utf-8")
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path
