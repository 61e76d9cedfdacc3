"""Numbers read from states, on states whose numbers are known."""

import numpy as np
import pytest

from doseki.validate import estimators
from doseki.validate.cases.free_surfaces.drops import ellipse
from doseki.validate.cases.grains import dry, wet
from doseki.validate.cases.streams import not_newtonian
from doseki.validate.cases.streams.films import KEULEGAN, nusselt_speed
from doseki.validate.cases.streams.poiseuille import exact_speed


def state(position, velocity=0.0, **fields):
    position = np.array(position, float)
    n = len(position)
    given = {
        "position": position,
        "velocity": np.broadcast_to(np.array(velocity, float), position.shape),
        "mass": np.ones(n),
        "density": np.full(n, 2.0),
    }
    return given | fields


def test_sums():
    turning = state([[1, 0], [0, 1], [-1, 0], [0, -1]], [[0, 3], [-3, 0], [0, -3], [3, 0]])
    assert estimators.kinetic_energy(turning) == pytest.approx(18)
    assert estimators.angular_momentum(turning) == pytest.approx(12)
    assert estimators.volume(turning) == pytest.approx(2)
    assert estimators.mean_velocity(turning) == pytest.approx(0)


def test_amplitude_of_a_wave():
    y = (np.arange(40) + 0.5) / 40
    wave = state(np.stack([y, y], axis=1), np.stack([0.3 * np.sin(2 * np.pi * y), 0 * y], axis=1))
    assert estimators.wave_amplitude(wave, 0, 1, 2 * np.pi) == pytest.approx(0.3)


def test_crossings():
    t = np.linspace(0, 4, 401)
    zeros = estimators.crossings(t, np.cos(np.pi * t))
    np.testing.assert_allclose(zeros, [0.5, 1.5, 2.5, 3.5], atol=1e-6)


def test_front_and_level():
    column = state([[0.05, 0.05], [0.05, 0.15], [0.45, 0.05]])
    assert estimators.front(column, 0.1) == pytest.approx(0.5)
    assert estimators.level(column, (0.05,), 0.1) == pytest.approx(0.2)
    assert estimators.level(column, (0.25,), 0.1) == 0


def test_pressure_at_a_point_of_a_wall():
    y = np.arange(10) * 0.1
    wall = state(np.stack([0 * y, y], axis=1), pressure=100 * y)
    assert estimators.pressure_at(wall, (0, 0.5), 0.1) == pytest.approx(50)
    assert estimators.pressure_at(wall, (0, 0.55), 0.1) == pytest.approx(55)


def test_what_is_torn_is_loose():
    x, y = np.meshgrid(np.arange(30.0), np.arange(20.0))
    block = np.stack([x.ravel(), y.ravel()], axis=1)
    assert estimators.loose_share(state(block), 1.6) == 0
    torn = np.concatenate([block, [[100, 0], [102, 0], [104, 5], [90, 90]]])
    assert estimators.loose_share(state(torn), 1.6) == pytest.approx(4 / 604)


def test_exact_solutions():
    """Against the values that are published or follow by hand."""
    assert ellipse(100, 0.0076) == pytest.approx((0.51427, 1.94452), abs=1e-5)
    assert np.prod(ellipse(100, 0.0076)) == pytest.approx(1)
    assert pytest.approx(2.07, abs=0.005) == KEULEGAN
    assert nusselt_speed(0.02) == pytest.approx(0.6710, abs=1e-4)
    y = np.linspace(0, 1, 11)
    np.testing.assert_allclose(exact_speed(y, 0.0), 0, atol=1e-4)
    np.testing.assert_allclose(exact_speed(y, 1e3), 4 * y * (1 - y), atol=1e-12)


def test_casson_s_profile_is_the_integral_of_its_law():
    """From the wall inwards, sqrt(eta |du/dy|) = sqrt(tau) - sqrt(tau_y), and 0 in the plug."""
    y = np.linspace(0, 0.5, 20001)
    excess = np.maximum(np.sqrt(800 * (0.5 - y)) - np.sqrt(100), 0)
    rate = excess**2 / 40
    integrated = np.concatenate([[0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(y))])
    np.testing.assert_allclose(not_newtonian.casson_speed(y), integrated, atol=1e-8)
    np.testing.assert_allclose(not_newtonian.casson_speed(1 - y), integrated, atol=1e-8)
    assert not_newtonian.casson_speed(np.array(0.5)) == pytest.approx(35 / 96)


def test_what_lies_apart_is_no_part_of_the_heap():
    heap, shift = np.stack([np.arange(5.0), np.zeros(5)], axis=1), np.array([20, 0])
    both = np.concatenate([heap + shift, [[8.0, 0], [9.0, 0]], [[40.0, 3]]])
    assert np.array_equal(estimators.largest_cluster(both, 1.1), heap + shift)


def test_slope_of_a_heap_with_a_plateau():
    x = np.linspace(0, 10, 400, endpoint=False)
    y = np.minimum(4.0, 6 - 0.6 * x)
    below = np.stack([np.tile(x, 2), np.concatenate([y, 0.5 * y])], axis=1)
    angle, edge, top = estimators.surface_slope(below, 0.5, 10.0)
    assert np.tan(angle) == pytest.approx(0.6, rel=1e-6)
    assert len(edge) == len(top) == 20


def test_closed_forms_of_grains():
    assert dry.published(2.0) == pytest.approx((2.4, 3.6))
    assert dry.published(5.0) == pytest.approx((1.9 * 5 ** (2 / 3), 2.3 * 5 ** (2 / 3)))
    series = np.log(4) - 0.9157 + 1.7244 / 16 - 1.7302 / 256
    net = np.pi / 4 * 1e-4 * 1000 * 9.81
    stone = wet.faxen_speed(*wet.STONE, 0.04)
    assert stone == pytest.approx(net * series / (4 * np.pi))
    for share, drag in {0.05: 15.56, 0.1: 24.83, 0.2: 51.53}.items():  # tabulated by the authors
        assert wet.array_drag(np.sqrt(4 / np.pi * share)) == pytest.approx(drag, rel=0.02)
