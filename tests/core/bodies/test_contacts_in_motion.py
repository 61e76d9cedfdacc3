"""Contacts are the same whatever moves both sides together, though steps differ in length.

The time of a wall that is half a step ahead of what touches it shows where steps change: they do
here, as beside a fluid, which has steps of its own.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doseki.scene.lattices import rotation_matrix

from .blocks import assert_restored_with_the_same_bits, ball, box, head, moving, started

RADIUS, WIDTH, DP = 0.08, 0.12, 0.02
CHALK = """
[material.chalk]
law = "solid"
rho0 = 1000
young_modulus = 1e7
poisson_ratio = 0.2
restitution = 0.5
fracture = "cohesive"
tensile_strength = 2e5
fracture_energy = 100

"""
SETTINGS = [(2, 0, "linear"), (2, 30, "linear"), (3, 0, "linear"), (3, 30, "hertz")]
settings = pytest.mark.parametrize(("dim", "degrees", "law"), SETTINGS)


class Frame:
    """A floor and what lies or falls on it, all of which goes with `speed` along the normal."""

    def __init__(
        self, folder, setting, speed, *, gravity=0.0, fall=0.0, gap=0.0, shape="ball", **values
    ):
        """The body comes with `fall` from `gap` above the floor; `values` go into its table."""
        dim, degrees, law = setting
        turn = rotation_matrix(degrees, dim)
        self.up, self.speed = turn[:, -1], speed
        text = head((-gravity * self.up).tolist(), DP, speed=4, law=law, restitution=0.5)
        turned = {"rotate": degrees, "pivot": [0.0] * dim} if degrees else {}
        motion = f"{{ velocity = {(speed * self.up).tolist()}, start = 0, stop = 9 }}"
        low, high = [*[-WIDTH] * (dim - 1), -4 * DP], [*[WIDTH] * (dim - 1), 0]
        text += box("floor", low, high, fixed=True, motion=motion, **turned)
        velocity = ((speed - fall) * self.up).tolist()
        middle = np.array([*[0.0] * (dim - 1), RADIUS + gap])
        if shape == "ball":
            text += ball("body", turn @ middle, RADIUS, velocity=velocity, **values)
        else:
            text += box("body", middle - RADIUS, middle + RADIUS, velocity=velocity, **turned)
        self.run = started(folder, text.replace("\n[contact]", CHALK + "[contact]"))

    def advance(self, start, end):
        """Where the body is and how fast, m and m/s from the floor, after steps of many lengths."""
        rows = []
        for time in uneven(start, end, 2e-4):
            self.run.advance(time)
            (centre,), (velocity,) = (moving(self.run, of) for of in ("centre", "velocity"))
            rows.append([centre @ self.up - self.speed * time, velocity @ self.up - self.speed])
        return np.array(rows)


def uneven(start, end, mean, seed=1):
    """Times from `start` to `end`, apart by half to three halves of `mean`."""
    steps = mean * np.random.default_rng(seed).uniform(0.5, 1.5, int(2 * (end - start) / mean))
    times = start + np.cumsum(steps)
    return [*times[times < end], end]


@settings
@pytest.mark.parametrize("speed", [-3.0, 3.0])
def test_what_bounces_off_a_floor_does_so_in_any_frame(tmp_path, dim, degrees, law, speed):
    def restitution(of_frame):
        frame = Frame(tmp_path, (dim, degrees, law), of_frame, fall=0.1, gap=0.001)
        return frame.advance(0, 0.05)[-1, 1] / 0.1

    at_rest = restitution(0.0)
    assert at_rest == pytest.approx(0.5, abs=0.01)
    assert restitution(speed) == pytest.approx(at_rest, abs=0.005)


@pytest.mark.parametrize("fall", [0.1, 2.0])
@pytest.mark.parametrize("kind", ["elastic", "breakable"])
@pytest.mark.parametrize(("dim", "degrees"), [(2, 0), (2, 30), (3, 0)])
def test_what_deforms_bounces_alike_in_any_frame(tmp_path, dim, degrees, kind, fall):
    """Also what is rigid until it is struck, as it is at 2 m/s."""
    kinds = {"material": '"chalk"', "kinematics": f'"{kind}"'}

    def bounced(speed):
        setting = dim, degrees, "linear"
        frame = Frame(tmp_path, setting, speed, fall=fall, gap=0.001, **kinds)
        for time in uneven(0, 0.03, 2e-4):
            state = frame.run.advance(time)
        deforms = len(frame.run.simulation.fragments()["mass"]) > 0
        return state["velocity"][state["body"] == 1].mean(axis=0) @ frame.up - speed, deforms

    at_rest, deforms = bounced(0.0)
    assert at_rest > 0.4 * fall
    assert deforms == (kind == "elastic" or fall == 2.0)
    assert bounced(-3.0) == pytest.approx((at_rest, deforms), rel=1e-6)


@settings
@pytest.mark.parametrize("shape", ["ball", "box"])
@pytest.mark.parametrize("speed", [-1.5, 1.5])
def test_what_lies_on_a_lift_lies_still(tmp_path, dim, degrees, law, shape, speed):
    """As deep as on a floor that stands, and no force comes and goes."""

    def lying(of_frame):
        frame = Frame(tmp_path, (dim, degrees, law), of_frame, gravity=9.81, shape=shape)
        frame.advance(0, 0.1)
        return frame.advance(0.1, 0.12).T

    depth, moves = lying(speed)
    assert np.abs(moves).max() < 1e-6
    assert depth == pytest.approx(lying(0.0)[0], abs=1e-8)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_wall_that_turns_is_where_it_should_be(tmp_path, dim):
    """Parts of steps add up to the turn, and the velocity is that of where it has come to."""
    rate, start, end = 5.0, 0.01, 0.13
    spin = np.multiply(rate, [0, 0, 1] if dim == 2 else [0, 0.6, 0.8])
    pivot, drift, level = np.array([0.1, 0, 0]), np.array([0.5, 0, 0]), [0.0] * (dim - 1)
    motion = {
        "velocity": drift[:dim].tolist(), "angular_velocity": rate if dim == 2 else spin.tolist(),
        "pivot": pivot[:dim].tolist(), "start": start, "stop": 9.0,
    }  # fmt: skip
    given = ", ".join(f"{key} = {value}" for key, value in motion.items())
    text = head([0.0] * dim, DP)
    sides = np.subtract([0.2, *level], 0.05), np.add([0.2, *level], 0.05)
    text += box("plate", *sides, fixed=True, motion=f"{{ {given} }}")
    run = started(tmp_path, text + ball("far", [2.0, *level], RADIUS))
    for time in uneven(0, end, 2e-3):
        run.advance(time)
    grains = run.grains()
    (centre,), (velocity,) = (grains[of][grains["fixed"]] for of in ("centre", "velocity"))
    arm = Rotation.from_rotvec((end - start) * spin).apply([0.1, 0, 0])
    assert centre == pytest.approx((pivot + (end - start) * drift + arm)[:dim], abs=1e-13)
    assert velocity == pytest.approx((drift + np.cross(spin, arm))[:dim], abs=1e-12)


def test_a_wall_that_turns_strikes_as_fast_as_it_comes(tmp_path):
    """A light ball leaves a heavy arm with twice the speed of the place that it meets."""
    rate = 2.0
    text = head([0.0, 0.0], 0.01, speed=4, restitution=1.0, friction=0)
    motion = f"{{ angular_velocity = {rate}, pivot = [0.0, 0.0], start = 0, stop = 9 }}"
    text += box("arm", [0.0, -0.05], [1.0, 0.0], fixed=True, motion=motion)
    run = started(tmp_path, text + ball("ball", [0.8, 0.05], 0.03))
    for time in uneven(0, 0.05, 1e-3):
        run.advance(time)
    assert np.linalg.norm(moving(run, "velocity")[0]) == pytest.approx(2 * rate * 0.8, rel=0.005)


def test_a_restored_lift_goes_on_with_the_same_bits(tmp_path):
    frame = Frame(tmp_path, (2, 30, "linear"), 1.5, gravity=9.81, fall=0.1)
    frame.advance(0, 0.02)
    assert_restored_with_the_same_bits(frame.run, moving_bodies=1, until=0.04)
