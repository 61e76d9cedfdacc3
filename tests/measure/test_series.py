"""Numbers of a series, and the filter, on signals whose answer is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.measure.series import arrival, first_above, impulse, peak
from doseki.util.low_pass import LowPass, low_passed


def uneven(end, count, seed=1):
    times = np.sort(np.random.default_rng(seed).uniform(0, end, count))
    times[0] = 0.0
    return times


def test_peak_arrival_and_impulse_of_a_triangle():
    times, values = np.array([0.0, 1.0, 2.0, 4.0]), np.array([0.0, 0.0, 8.0, 0.0])
    assert peak(times, values) == (8.0, 2.0)
    assert arrival(times, values) == pytest.approx(1.25)
    assert arrival(times, values, 0.5) == pytest.approx(1.5)
    assert impulse(times, values, 0, 4) == pytest.approx(12)
    assert impulse(times, values, 1.5, 2) == pytest.approx(3)
    assert math.isnan(arrival(times, -values))


def test_first_above():
    t = np.linspace(0, 4, 401)
    assert first_above(t, t**2, 1.0) == pytest.approx(1.0)
    assert first_above(t, t, -1.0) == 0
    assert np.isnan(first_above(t, t, 5.0))


def test_impulse_of_a_line():
    t = np.linspace(0, 2, 201)
    assert impulse(t, t, 0, 1) == pytest.approx(0.5)


def test_an_impulse_goes_to_its_ends_between_samples():
    """As from sparse samples, so from dense ones of the same broken line."""
    t = np.array([0.1, 1.0, 3.0])
    values = np.array([2.0, 4.0, 0.0])
    dense = np.linspace(0, 3, 3001)
    assert impulse(t, values, 0.5, 2.0) == pytest.approx(
        impulse(dense, np.interp(dense, t, values), 0.5, 2.0), rel=1e-6
    )
    assert impulse(t, values, 0, 0.1) == pytest.approx(0.2)


@pytest.mark.parametrize("ratio", [0.1, 1.0, 3.0])
def test_a_sine_is_damped_and_turned_as_butterworth_says(ratio):
    """H = 1/(1 - r^2 + i sqrt(2) r), in steps of any length."""
    f = 20.0
    times = uneven(1.0, 20_000)
    shown = low_passed(times, np.sin(2 * np.pi * f * ratio * times), f)
    late = times > 0.4
    angle = 2 * np.pi * f * ratio * times[late]
    in_phase, behind = np.linalg.lstsq(
        np.stack([np.sin(angle), np.cos(angle)], 1), shown[late], rcond=None
    )[0]
    expected = 1 / (1 - ratio**2 + 1j * math.sqrt(2) * ratio)
    assert complex(in_phase, behind) == pytest.approx(expected, abs=2e-3 * abs(expected) + 1e-5)


def test_a_broken_line_is_filtered_the_same_in_any_steps():
    knots, values = np.array([0.0, 0.1, 0.15, 0.4]), np.array([1.0, 1.0, 9.0, 2.0])
    times = np.union1d(uneven(0.4, 500), knots)
    fine = low_passed(times, np.interp(times, knots, values), 7.0)
    coarse = low_passed(knots, values, 7.0)
    assert fine[np.searchsorted(times, knots)] == pytest.approx(coarse, rel=1e-12)


def test_a_filter_keeps_what_does_not_change_and_the_impulse_of_what_does():
    times = uneven(2.0, 4000)
    assert low_passed(times, np.full(len(times), 3.0), 50.0) == pytest.approx(3.0, rel=1e-12)
    pulse = np.exp(-(((times - 0.5) / 0.02) ** 2))
    shown = low_passed(times, pulse, 10.0)
    assert shown.max() < 0.8 * pulse.max()
    assert impulse(times, shown, 0, 2) == pytest.approx(impulse(times, pulse, 0, 2), rel=2e-3)


def test_a_filter_does_not_know_the_future():
    times = np.linspace(0, 1, 101)
    one, other = np.sin(times), np.where(times > 0.5, 99.0, np.sin(times))
    before = times <= 0.5
    shown = [low_passed(times, signal, 5.0)[before] for signal in (one, other)]
    np.testing.assert_array_equal(*shown)


def test_a_filter_goes_on_from_its_state():
    times = uneven(1.0, 200)
    signal = np.cos(9 * times)
    straight, first = LowPass(4.0), LowPass(4.0)
    assert math.isnan(straight.value)
    for time, value in zip(times, signal, strict=True):
        straight.add(time, value)
    for time, value in zip(times[:90], signal[:90], strict=True):
        first.add(time, value)
    second = LowPass(4.0)
    second.state = first.state
    for time, value in zip(times[90:], signal[90:], strict=True):
        second.add(time, value)
    assert second.state == straight.state
