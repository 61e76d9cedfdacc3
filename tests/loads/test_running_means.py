"""Running means of a record: exact for what is constant between samples."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.loads import Loads, as_json, load_lines
from doseki.measure.loads import BodyLoad, Series, _step_peak, running_peak


def integral(time, mean):
    return np.concatenate([[0.0], np.cumsum(mean * np.diff(time))])


def test_a_pulse_is_averaged_over_the_window():
    """3 ms of 100 N in a window of 10 ms: 30 N, and its middle lies where all of it is inside."""
    time = np.linspace(0, 0.5, 501)
    mean = np.where((time[1:] > 0.2) & (time[1:] < 0.2035), 100.0, 0.0)
    peak = running_peak(time, integral(time, mean), 0.01)
    assert peak.value == pytest.approx(30)
    assert 0.198 <= peak.time - 0.005 + 0.01 <= 0.2131
    assert running_peak(time, integral(time, mean), 0.1).value == pytest.approx(3)


def test_a_step_keeps_its_height():
    time = np.linspace(0, 1, 201)
    mean = np.where(time[1:] > 0.5, 7.0, -2.0)
    for window in (0.01, 0.1):
        assert running_peak(time, integral(time, mean), window).value == pytest.approx(7)


@pytest.mark.parametrize("seed", range(8))
def test_windows_between_samples_are_found(seed):
    """The highest mean of uneven samples, against a search through many windows."""
    random = np.random.default_rng(seed)
    time = np.concatenate([[0.0], np.cumsum(random.uniform(0.001, 0.004, 200))])
    whole = integral(time, random.normal(size=200))
    peak = running_peak(time, whole, 0.01)
    begins = np.linspace(0, time[-1] - 0.01, 200_001)
    means = (np.interp(begins + 0.01, time, whole) - np.interp(begins, time, whole)) / 0.01
    assert peak.value >= means.max() - 1e-9
    assert peak.value == pytest.approx(means.max(), rel=1e-3)


def test_where_nothing_acts_there_is_no_time_of_a_peak():
    time = np.linspace(0, 1, 201)
    peak = running_peak(time, 0 * time, 0.01)
    assert (peak.value, np.isnan(peak.time)) == (0, True)
    # The core names a time in each interval, also of nothing.
    none = {f"peak_force_{axis}": np.array([np.nan, 0.0, 0.0]) for axis in "xy"}
    columns = none | {"peak_time": np.array([np.nan, 0.01, 0.06])}
    peak = _step_peak(columns, np.array([1.0, 0.0]), 2)
    body = BodyLoad("dam", np.eye(2)[0], peak, {"total": Series({0.01: peak}, 0.0)}, "N/m", 0.05)
    lines = [text for _, text in load_lines(Loads(2, [body], []))]
    assert lines[0] == "nothing acted"
    assert not any("nan" in text for text in lines)
    assert as_json(Loads(2, [body], []))["bodies"]["dam"]["step_peak"] == {"value": 0, "time": None}


def test_what_samples_cannot_show_is_none():
    time = np.linspace(0, 1, 11)
    for window in (0.01, 2.0):
        assert np.isnan(running_peak(time, time, window).value)
    assert running_peak(time, time, 0.1).value == pytest.approx(1)
