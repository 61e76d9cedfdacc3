"""Balls that touch across a periodic axis do so on each side on which they do."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import assert_restored_with_the_same_bits, ball, head, moving, started

RADIUS, PERIOD = 0.1, 0.399  # half a millimetre on each side of two in the middle
CASES = [(2, "x"), (2, "y"), (3, "x"), (3, "z")]
cases = pytest.mark.parametrize(("dim", "axis"), CASES)


def two(folder, dim, axis, apart, *, period=PERIOD, friction=0.0, **values):
    """Two balls this far apart, m; without a period along an open axis."""
    along = "xyz".index(axis)
    text = head([0.0] * dim, 0.02, restitution=1.0, friction=friction)
    if period:
        low, high = np.full(dim, -5.0), np.full(dim, 5.0)
        low[along], high[along] = 0, period
        domain = f'periodic = ["{axis}"]\ndomain_min = {low.tolist()}\ndomain_max = {high.tolist()}'
        text = text.replace("\n[contact]", f"{domain}\n\n[contact]")
    for name, place in (("one", 0.15), ("other", 0.15 + apart)):
        text += ball(name, place * np.eye(dim)[along], RADIUS, **(values if name == "one" else {}))
    return started(folder, text)


def pushed(run, axis, time=1e-6):
    """Velocity along the axis that the first one has from almost nothing but its place, m/s."""
    run.advance(time)
    one, other = moving(run, "velocity")[:, "xyz".index(axis)]
    assert one == pytest.approx(-other, abs=1e-12 * abs(one))
    return one


@cases
@pytest.mark.parametrize("apart", [0.1999, 0.1991])
def test_balls_that_touch_on_both_sides_are_pushed_by_both(tmp_path, dim, axis, apart):
    """By 0.1 mm on one side and 0.9 mm on the other: the forces of two that touch on one alone."""
    by_both = pushed(two(tmp_path, dim, axis, apart), axis)
    sides = [apart, PERIOD - apart]
    near, far = (pushed(two(tmp_path, dim, axis, side, period=0), axis) for side in sides)
    assert by_both == pytest.approx(near - far, rel=1e-6)
    assert abs(by_both) > 0.8 * max(abs(near), abs(far))
    assert two_rest(tmp_path, dim, axis) < 1e-12 * abs(by_both)


def two_rest(folder, dim, axis):
    """The speed where both sides press alike, m/s."""
    return abs(pushed(two(folder, dim, axis, PERIOD / 2), axis))


@cases
def test_balls_between_their_images_swing_for_ever(tmp_path, dim, axis):
    """They pass the middle, where the nearer side is another one, and come back as far."""
    run, along = two(tmp_path, dim, axis, 0.1999), "xyz".index(axis)
    apart = []
    for time in np.linspace(0, 0.2, 400):
        run.advance(time)
        one, other = moving(run, "centre")[:, along]
        apart.append((other - one) % PERIOD - PERIOD / 2)
    late = apart[-100:]
    assert max(apart[:100]) == pytest.approx(4e-4, rel=0.01)
    assert min(late) == pytest.approx(-4e-4, rel=0.01)
    assert max(late) == pytest.approx(4e-4, rel=0.01)
    passed = np.flatnonzero(np.diff(np.sign(apart)))
    assert len(passed) > 10
    assert np.ptp(np.diff(passed)) <= 1  # always after the same time


def test_a_ball_that_turns_between_two_images_is_braked_on_both_sides(tmp_path):
    """Friction of two contacts turns it with twice the force of one, and moves nothing aside."""
    spin = {"spin": 5.0}
    both = two(tmp_path, 2, "x", PERIOD / 2, friction=0.5, **spin)
    single = two(tmp_path, 2, "x", PERIOD / 2, period=0, friction=0.5, **spin)
    for run in (both, single):
        run.advance(2e-5)
    lost = [5.0 - moving(run, "spin")[0, 2] for run in (both, single)]
    assert lost[0] == pytest.approx(2 * lost[1], rel=0.01)
    assert np.abs(moving(both, "velocity")).max() < 0.01 * np.abs(moving(single, "velocity")).max()


def test_contacts_on_both_sides_are_restored_with_the_same_bits(tmp_path):
    run = two(tmp_path, 2, "x", 0.1999, friction=0.5, spin=5.0)
    run.advance(0.01)
    assert_restored_with_the_same_bits(run, moving_bodies=2, until=0.02)
