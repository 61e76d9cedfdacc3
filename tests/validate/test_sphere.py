"""What is read from a fall beside the measured one."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.cases.grains.sphere import LATE, SPEED, THICK, THIN, WAY, judged
from doseki.validate.reference import read_columns


def fall(oil, slower=1.0):
    """The measured fall, `slower` times as slow."""
    times = np.linspace(0, 1, 201)
    speed = np.interp(times, *read_columns(oil.speeds)) / slower
    t, height = read_columns(oil.heights)
    way = height[0] - np.interp(times, t, height)
    return judged(oil, times, speed, height[0] - way / slower).values


@pytest.mark.parametrize("oil", [THIN, THICK])
def test_the_measured_fall_misses_nothing(oil):
    values = fall(oil)
    assert values[LATE].error == pytest.approx(0, abs=0.03)
    assert values[SPEED].number < 0.02
    assert values[WAY].number < 0.01


@pytest.mark.parametrize("oil", [THIN, THICK])
def test_a_slower_fall_misses_as_much_as_it_is_slower(oil):
    values = fall(oil, 1.25)
    assert values[LATE].error == pytest.approx(-0.2, abs=0.03)
    assert values[SPEED].number == pytest.approx(0.2, abs=0.03)
    assert values[WAY].number == pytest.approx(0.2, abs=0.02)


def test_measured_ways_are_those_of_the_measured_speeds():
    """Two readings of one experiment: figures 5a and 5b."""
    for oil in (THIN, THICK):
        t, u = read_columns(oil.speeds)
        times, height = read_columns(oil.heights)
        late = np.linspace(0.5, 0.95, 100)
        way = np.trapezoid(np.interp(late, t, u), late) / 0.015
        assert -np.diff(np.interp(late[[0, -1]], times, height))[0] == pytest.approx(way, rel=0.1)
