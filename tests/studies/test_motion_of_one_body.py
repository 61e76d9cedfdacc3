"""What a study takes of a gauge of kind motion: of one body it is a row for each time."""

from __future__ import annotations

import pytest

from doseki.errors import UserError
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario
from doseki.studies.plan.file import read_plan

from .small_study import SCENARIO, STUDY, write_study

STONE = """
[body.stone]
shape = "disc"
material = "basalt"
centre = [2, 0.5]
radius = 0.2
{more}

[gauge.stone]
kind = "motion"
bodies = ["stone"]
interval = 0.01
{grains}
"""
COPIES = "array = { count = [2, 1], step = [1, 1] }"
PACKING = STONE.replace(
    "centre = [2, 0.5]\nradius = 0.2", "min = [2, 0]\nmax = [4, 2]\nd = 0.4\ncount = 4"
)
TAKE = '\n[result.y]\nkind = "gauge"\ngauge = "stone"\ncolumn = "y"\ntake = "{take}"\n'


@pytest.mark.parametrize(
    ("text", "more", "grains", "several"),
    [
        (STONE, "", "", False),
        (STONE, COPIES, "", True),
        (STONE, COPIES, "grains = [1]", False),
        (PACKING, "", "", True),
        (PACKING, "", "grains = [1]", False),
    ],
)
def test_one_body_has_a_row_for_each_time(tmp_path, text, more, grains, several):
    scenario = SCENARIO + text.format(more=more, grains=grains)
    for take in ("last", "first"):
        path = write_study(tmp_path, STUDY + TAKE.format(take=take), scenario)
        if not several:
            assert read_plan(path)
            continue
        with pytest.raises(UserError, match=r"\.gauge: a gauge of kind motion has several rows"):
            read_plan(path)


def test_the_last_row_is_the_last_place(tmp_path):
    path = write_study(
        tmp_path, STUDY + TAKE.format(take="last"), SCENARIO + STONE.format(more="", grains="")
    )
    result = read_plan(path).results["y"]
    run_scenario(load_scenario(str(tmp_path / "fall.toml")), tmp_path / "run")
    run = load(tmp_path / "run")
    assert result.read(run) == pytest.approx(run[-1].grains["position"][0, 1])
    assert result.read(run) < 0.5
