"""Times of outputs: multiples of an interval, and times that are meant to be one are one."""

from __future__ import annotations

import math

import pytest

from doseki.driver.schedule import OutputTimes


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
