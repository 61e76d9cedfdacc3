"""Times of outputs: multiples of an interval, and times that are meant to be one are one."""

from __future__ import annotations

import math
import time

import pytest

from doseki.driver.schedule import CheckpointClock, OutputTimes, steps_between


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
