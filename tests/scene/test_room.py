"""Before a run is said: of what body little is left, what leaves at once, what begins too late."""

from __future__ import annotations

import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene

from ..small_scenarios import BLOCK

SCHEME = 'scheme = "resolved"\nspeed_max = 2'
DAM = """
[body.dam]
shape = "box"
material = "basalt"
fixed = true
min = [0, 0]
max = [{right}, 1]
"""
DISCS = """
[body.discs]
shape = "disc"
material = "basalt"
d = 0.24
packing = 0.6
min = [0, 0]
max = [1, 0.5]
settle = false
"""
OUTFLOW = """
[outflow.end]
min = [{left}, "-inf"]
max = ["inf", "inf"]
"""
GATE = """
[body.gate]
shape = "box"
material = "basalt"
fixed = true
min = [2, 0]
max = [2.3, 1]
motion = {{ velocity = [0, 2], {times} }}
"""
SPRING = """
[inflow.spring]
material = "water"
hydrograph = [[0, 0], [{first}, 0], [9, 0.1]]
width = 1
position = [2, 2]
direction = [1, 0]
depth = 0.4
start = 0.5
"""

RISING = SPRING.replace("hydrograph", "surge").replace("depth = 0.4\n", "")
RISING = RISING.replace(
    "[[0, 0], [{first}, 0], [9, 0.1]]", "[[0, {t0}, 1], [{first}, {t1}, {v1}], [9, 0.4, 1]]"
)


@pytest.fixture
def told(write):
    """What is said of a block of water, 10 by 5 particles, with other tables."""

    def tell(tables: str) -> list[str]:
        scene = build_scene(load_scenario(write(SCHEME, BLOCK + tables)))
        return [str(warning) for warning in scene.warnings]

    return tell


def test_a_body_that_another_swallows_is_refused(told):
    with pytest.raises(
        UserError, match=r"line 8: body\.block: nothing of it is left, .* body\.dam"
    ):
        told(DAM.format(right=1))


def test_a_body_that_is_mostly_in_a_wall_is_told(told):
    (said,) = told(DAM.format(right=0.6))
    assert said.startswith("body.block: 60 % of it lies inside fixed bodies")
    assert "body.dam" in said
    assert told(DAM.format(right=0.4)) == []


def test_water_in_the_pores_of_grains_is_meant(told):
    said = told(DISCS)
    assert not any("is left out" in each for each in said)


def test_what_starts_in_an_outflow_is_told(told):
    (said,) = told(OUTFLOW.format(left=0.8))
    assert said.startswith("outflow.end: 10 of the 50 particles of block start inside it")
    (said,) = told(OUTFLOW.format(left=-1))
    assert said.startswith("outflow.end: all of block starts inside it")
    assert told(OUTFLOW.format(left=1)) == []


def test_bodies_in_an_outflow_are_told(told):
    said = told(DISCS.replace("min = [0", "min = [2").replace("max = [1", "max = [3")
                + OUTFLOW.format(left=1))  # fmt: skip
    assert any(each.startswith("outflow.end: all of discs starts inside it") for each in said)


@pytest.mark.parametrize(("left", "is_far"), [(100, True), (2, False)])
def test_an_outflow_far_from_everything_is_told(told, left, is_far):
    said = told(OUTFLOW.format(left=left))
    assert [each.startswith("outflow.end: lies ") for each in said] == [True] * is_far


def test_a_figure_of_times_after_the_end_is_told(told):
    figure = '[figure.late]\nkind = "snapshot"\ntimes = [0.5, {}]\n'
    (said,) = told(figure.format(4))
    assert said.startswith("figure.late.times: not before 4 s, and the run ends at")
    assert told(figure.format(1)) == []


@pytest.mark.parametrize(
    ("tables", "place"),
    [
        (GATE.format(times="start = 1.5"), "body.gate.motion.start: not before 1.5 s"),
        (GATE.format(times="removed_at = 7"), "body.gate.motion.removed_at: not before 7 s"),
        (SPRING.format(first=0.6), "inflow.spring: not before 1.1 s"),
        (RISING.format(first=0.6, t0=0, t1=0, v1=1), "inflow.spring: not before 1.1 s"),
    ],
)
def test_what_begins_after_the_end_is_told(told, tables, place):
    (said,) = told(tables)
    assert said.startswith(f"{place}, and the run ends at time_max = 1 s")


@pytest.mark.parametrize(
    "tables",
    [
        GATE.format(times="start = 0.9"),
        SPRING.format(first=0.1),
        RISING.format(first=0.6, t0=0, t1=0.4, v1=1),
        RISING.format(first=0.6, t0=0.4, t1=0.4, v1=0),
        RISING.format(first=0.6, t0=0.4, t1=0, v1=1),
    ],
)
def test_what_begins_in_time_is_not(told, tables):
    assert told(tables) == []


def test_an_interval_longer_than_the_run_is_told(told):
    gauge = '[gauge.deep]\nkind = "pressure"\nposition = [0.5, 0.1]\ninterval = {}\n'
    (said,) = told(gauge.format(1.5))
    assert said.startswith("gauge.deep.interval = 1.5 s is longer than the run, 1 s: it is due at")
    assert told(gauge.format(1)) == []
