"""Measures of a run against values known by construction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.measure import numbers as measure


def test_frame_turns_from_the_first_axis_towards_the_last():
    assert np.allclose(measure.to_frame(np.array([[0.0, 2.0]]), 90.0), [[2.0, 0.0]])
    assert np.allclose(measure.to_frame(np.array([[0.0, 5.0, 2.0]]), 90.0), [[2.0, 5.0, 0.0]])


def test_window_of_turned_axes_holds_what_a_turned_box_holds():
    angle = math.radians(30.0)
    along = np.array([math.cos(angle), math.sin(angle)])
    position = np.array([0.9 * along, 1.1 * along, [0.9, 0.0]])
    inside = measure.in_window(position, np.array([0.0, -0.1]), np.array([1.0, 0.1]), 30.0)
    assert list(inside) == [True, False, False]


def test_filled_fraction():
    assert measure.filled_fraction(np.array([0.05, 0.06, 0.95]), 0.0, 1.0) == 0.2
    assert measure.filled_fraction(np.array([]), 0.0, 1.0) == 0.0


def test_histogram_has_bins_of_a_tenth_from_zero_and_counts_all():
    edges, counts = measure.speed_histogram(np.array([0.0, 0.05, 0.25, 0.31]))
    assert np.allclose(edges, [0.0, 0.1, 0.2, 0.3, 0.4])
    assert list(counts) == [2, 0, 1, 1]


@pytest.mark.parametrize("highest", [0.0, 0.1, 0.3, 0.7, 1.2])
def test_histogram_counts_speeds_on_an_edge(highest):
    _, counts = measure.speed_histogram(np.array([highest]))
    assert counts.sum() == 1


def test_samples_of_thirty_have_the_mean_and_spread_of_the_hypergeometric_law():
    speeds = np.repeat([0.05, 0.15], [60, 40])
    edges = measure.speed_edges(speeds)
    mean, low, high = measure.sampled_histogram(speeds, edges, size=30)
    spread = math.sqrt(30 * 0.6 * 0.4 * (100 - 30) / (100 - 1))
    assert mean[0] == pytest.approx(18.0, abs=0.2)
    assert mean.sum() == pytest.approx(30.0)
    assert (high - low)[0] == pytest.approx(2 * 1.645 * spread, abs=1.0)


def test_samples_are_the_same_every_time():
    speeds = np.random.default_rng(0).uniform(0, 1, 200)
    edges = measure.speed_edges(speeds)
    first, second = (measure.sampled_histogram(speeds, edges) for _ in range(2))
    assert np.array_equal(first, second)


def test_fewer_particles_than_a_sample_are_all_taken():
    speeds = np.array([0.05, 0.15, 0.16])
    mean, low, high = measure.sampled_histogram(speeds, measure.speed_edges(speeds))
    assert list(mean) == list(low) == list(high) == [1, 2]


def test_front_follows_the_flow():
    x = np.array([1.0, 3.0, 2.0])
    assert measure.front(x, -1) == 1.0
    assert measure.front(x, +1) == 3.0
    assert math.isnan(measure.front(np.array([]), 1))


def test_mean_velocity_is_that_of_the_centre_of_mass():
    velocity = np.array([[1.0, 0.0], [4.0, 3.0]])
    assert np.allclose(measure.mean_velocity(velocity, np.array([2.0, 1.0])), [2.0, 1.0])
    assert np.all(np.isnan(measure.mean_velocity(np.zeros((0, 2)), np.zeros(0))))


def test_passed_mass_counts_each_particle_once_and_those_removed():
    passed = measure.PassedMass(section=0.0, direction=-1)
    ids, mass = np.array([1, 2, 3]), np.array([1.0, 10.0, 100.0])
    assert passed.update(np.array([1.0, 1.0, -1.0]), mass, ids) == 0.0  # 3 was never upstream
    assert passed.update(np.array([-1.0, 1.0, -1.0]), mass, ids) == 1.0
    assert passed.update(np.array([1.0]), mass[1:2], ids[1:2]) == 1.0  # 1 and 3 have left
    assert passed.update(np.array([]), mass[:0], ids[:0]) == 11.0
    assert passed.update(np.array([0.5]), mass[:1], ids[:1]) == 11.0  # 1 has fallen back
    assert passed.update(np.array([-0.5]), mass[:1], ids[:1]) == 11.0


def test_without_a_direction_mass_passes_from_either_side_and_must_be_seen_there():
    passed = measure.PassedMass(section=0.0, direction=0)
    ids, mass = np.array([1, 2, 3]), np.array([1.0, 10.0, 100.0])
    assert passed.update(np.array([1.0, -1.0, -1.0]), mass, ids) == 0.0
    assert passed.update(np.array([-1.0, -2.0]), mass[:2], ids[:2]) == 1.0  # 3 is gone: who knows
    assert passed.update(np.array([-1.0, 2.0]), mass[:2], ids[:2]) == 11.0
    assert passed.update(np.array([1.0, -2.0]), mass[:2], ids[:2]) == 11.0  # and back again
    assert passed.count == 2


def test_passed_mass_is_exactly_zero_while_nothing_passes():
    mass = np.random.default_rng(0).uniform(size=1000)
    assert measure.PassedMass(0.0, -1).update(np.ones(1000), mass, np.arange(1000)) == 0.0


@pytest.mark.parametrize("direction", [1, 0])
def test_what_breaks_passes_part_by_part(direction):
    """1 falls into dust before the section, of which half passes; 2 breaks as it passes."""
    passed = measure.PassedMass(section=0.0, direction=direction)
    x, ids = np.array([-1.0, -1.0]), np.array([1, 2])
    assert passed.update(x, np.array([4.0, 10.0]), ids, np.array([-1, -1])) == 0
    x, ids, mass = np.array([1, -1, -1, 1, -1.0]), np.arange(2, 7), np.array([6.0, 2, 2, 3, 1])
    assert passed.update(x, mass, ids, np.array([2, 1, 1, 2, 2])) == 9
    assert passed.update(np.array([1, -1, 1, 1, 1.0]), mass, ids, ids) == 12
    assert passed.update(np.array([-1.0, 1, 1, 1, 1]), mass, ids, ids) == 14
    more = np.append(mass, 1.0), np.append(ids, 7), np.append(ids, 2)  # off what has passed
    assert passed.update(np.array([-1.0, 1, 1, 1, 1, -1]), *more) == 14
    assert passed.update(np.ones(6), more[0], more[1], more[1]) == 14
    assert passed.count == 5
