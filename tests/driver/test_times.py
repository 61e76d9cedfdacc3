"""Times of outputs: multiples of an interval, and times that are meant to be one are one."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from doseki.assess.preflight import check_scenario, preflight
from doseki.assess.summary import summary_text
from doseki.driver.schedule import CheckpointClock, OutputTimes, steps_between
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions
from doseki.scenario.load import load_scenario

from ..assess.accounts import recorded
from ..small_scenarios import CHALK


def walk(times):
    """All times of an output, one after the other."""
    found, now = [0.0], 0.0
    while (now := times.after(now)) < math.inf:
        found.append(now)
    return found


@pytest.mark.parametrize(
    ("interval", "last", "count"), [(0.1, 1.0, 11), (0.3, 1.0, 5), (0.7, 0.1, 2), (1e-4, 0.1, 1001)]
)
def test_every_multiple_comes_once_and_then_the_end(interval, last, count):
    found = walk(OutputTimes(interval, last))
    assert len(found) == count
    assert found[-1] == last
    assert found[:-1] == [number * interval for number in range(count - 1)]


def test_times_that_differ_by_rounding_are_one():
    assert 3 * 0.1 > 0.3
    tenths, thirds = OutputTimes(0.1, 1.0), OutputTimes(0.3, 1.0)
    assert tenths.after(0.3) == 0.4
    assert thirds.after(3 * 0.1) == 0.6
    assert tenths.is_due(0.3, 3 * 0.1)
    assert not tenths.is_due(0.3 * (1 - 1e-9), 0.3)


def test_after_any_time_comes_the_next_one():
    times = OutputTimes(0.013, 2.0)
    for number in range(150):
        planned = number * 0.013
        assert times.after(planned) == (number + 1) * 0.013
        assert times.after(planned + 0.006) == (number + 1) * 0.013


def test_checkpoints_by_wall_time_come_after_a_minute_then_at_the_usual_interval(monkeypatch):
    now = 1000.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    clock, written = CheckpointClock(None, minutes=10.0), []
    for second in range(1, 1400):
        now = 1000.0 + second
        if clock.is_due(simulated=0.0):
            clock.reset(simulated=0.0)
            written.append(second)
    assert written == [60, 660, 1260]


def test_shorter_intervals_than_a_minute_stay_as_they_are(monkeypatch):
    now = 0.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    clock = CheckpointClock(None, minutes=0.5)
    now = 30.0
    assert clock.is_due(simulated=0.0)


def test_a_run_without_simulated_interval_may_get_one_when_it_is_resumed():
    before = CheckpointClock(None, minutes=10.0)
    clock = CheckpointClock(0.5, 10.0, before.next_time)
    assert not clock.is_due(simulated=0.4)
    assert clock.is_due(simulated=0.6)
    clock.reset(simulated=3.2)
    assert not clock.is_due(simulated=3.4)
    assert clock.is_due(simulated=3.5)


def test_a_shorter_interval_counts_as_soon_as_a_run_is_resumed():
    clock = CheckpointClock(1.0, 10.0, next_time=20.0, simulated=12.3)
    assert not clock.is_due(simulated=12.9)
    assert clock.is_due(simulated=13.0)
    same = CheckpointClock(10.0, 10.0, next_time=20.0, simulated=12.3)
    assert not same.is_due(simulated=19.9)


@pytest.mark.parametrize(
    ("start", "intervals", "steps"),
    [
        (0.0, [], 34),  # 1/0.03
        (0.0, [1.0], 34),
        (0.0, [0.1], 40),  # 0.03 0.03 0.03 0.01, ten times
        (0.0, [0.1, 0.1], 40),
        (0.0, [0.1, 0.05], 40),  # two each: 0.03 0.02
        (0.0, [0.04], 50),
        (0.0, [0.02], 50),
        (0.5, [0.1], 20),
        (0.0, [0.3], 34),  # as 10 + 10 + 10 + 4
    ],
)
def test_outputs_end_steps(start, intervals, steps):
    assert steps_between(start, 1.0, 0.03, intervals) == steps


BODIES = """
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 6
time_max = 0.0024
time_out = 0.0012
time_history = 0.0001
gravity = [0, 0]

[body.disc]
shape = "disc"
material = "chalk"
kinematics = "{kinematics}"
centre = [0, 0]
radius = 0.03
velocity = [1, 0]

[gauge.disc]
kind = "mass_centre"
bodies = ["disc"]
interval = 0.0002
"""


@pytest.fixture(scope="module", params=["rigid", "elastic", "breakable"])
def bodies_alone(request, tmp_path_factory):
    text = BODIES.format(kinematics=request.param)
    return recorded(tmp_path_factory.mktemp(request.param), text + CHALK)


def test_bodies_alone_have_every_row_that_is_asked(bodies_alone):
    """Nothing else ends their steps, or hardly anything."""
    assert bodies_alone.history["dt"].max() == pytest.approx(0.0001)
    times = bodies_alone.history["time"]
    np.testing.assert_allclose(times, 0.0001 * np.arange(25), rtol=0, atol=1e-15)
    np.testing.assert_allclose(bodies_alone.gauges["disc"]["time"], 0.0002 * np.arange(13))


def test_bodies_alone_go_on_to_the_same_rows(bodies_alone, tmp_path):
    given = bodies_alone.scenario["body"]["disc"]["kinematics"]
    recorded(tmp_path, BODIES.format(kinematics=given) + CHALK, "time_max=0.0012")
    resume_run(tmp_path / "run", ["time_max=0.0024"], RunOptions(threads=1))
    again = load(tmp_path / "run").history
    for name in ("time", "step", "kinetic_energy", "elastic_energy"):
        assert np.array_equal(again[name], bodies_alone.history[name]), name


def test_the_steps_of_bodies_alone_are_foreseen(bodies_alone, tmp_path):
    """Also by the burst of a check, where outputs end steps."""
    given = bodies_alone.scenario["body"]["disc"]["kinematics"]
    file = tmp_path / "case.toml"
    file.write_text(BODIES.format(kinematics=given) + CHALK)
    expected = preflight(load_scenario(str(file)), threads=1)
    assert expected.steps == bodies_alone.summary["step"] == 24
    assert expected.timestep == pytest.approx(0.0001)


def test_steps_of_bodies_that_deform_are_told_of(bodies_alone, tmp_path):
    """Beside those of the run, of which each has many: 0.65 dp/c_P, with c_P = 333 m/s."""
    given = bodies_alone.scenario["body"]["disc"]["kinematics"]
    file = tmp_path / "case.toml"
    file.write_text(BODIES.format(kinematics=given) + CHALK)
    told = (
        "within these, steps of about 9.7e-06 s while a body deforms: some 246 of them if one"
        " deforms all the time"
    )
    for text in (check_scenario(load_scenario(str(file)), 1), summary_text(bodies_alone)):
        assert (told in text) == (given != "rigid")


def test_steps_that_nothing_limits_go_from_output_to_output():
    assert steps_between(0.0, 1.0, math.inf, [0.1]) == 10


def test_rows_that_nobody_asks_for_end_no_step(tmp_path):
    """Nor where the run goes on from half its time: a thousandth of each is another interval."""
    text = BODIES.format(kinematics="elastic").replace("time_history = 0.0001\n", "") + CHALK
    (tmp_path / "half").mkdir()
    whole = recorded(tmp_path, text)
    recorded(tmp_path / "half", text, "time_max=0.0012")
    resume_run(tmp_path / "half/run", ["time_max=0.0024"], RunOptions(threads=1))
    again = load(tmp_path / "half/run")
    assert whole.summary["step"] == again.summary["step"] < 30
    assert np.array_equal(whole[-1]["position"], again[-1]["position"])
