"""Balls that touch across a periodic axis do so on each side on which they do."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

from .blocks import assert_restored_with_the_same_bits, ball, body, box, head, moving, started

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


CROSSING = """\
dim = {dim}
dp = 0.02
scheme = "resolved"
speed_max = 2
time_max = 1
time_out = 1
gravity = {none}
periodic = ["y"]
domain_min = {low}
domain_max = {high}

[body.ball]
shape = "{shape}"
material = "basalt"
centre = {centre}
radius = 0.08
velocity = {velocity}
{kinematics}

[body.other]
shape = "{shape}"
material = "basalt"
centre = {other}
radius = 0.08

[outflow.end]
min = {first}
max = {last}
"""


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("sideways", [0.6, -0.6])
@pytest.mark.parametrize("kinematics", ["", 'kinematics = "elastic"'])
def test_what_has_gone_across_a_period_leaves_all_the_same(tmp_path, dim, sideways, kinematics):
    """An outflow that is as wide as the period takes out a body wherever its centre has gone."""

    def point(x, y, z):
        return [x, y] if dim == 2 else [x, y, z]

    text = CROSSING.format(
        dim=dim, none=[0.0] * dim, low=point(-1, 0, -1), high=point(3, 0.4, 1),
        shape="disc" if dim == 2 else "sphere", centre=point(0.2, 0.2, 0),
        velocity=point(2, sideways, 0), kinematics=kinematics,
        other=point(-0.7, 0.2, 0), first=point(1, 0, -1),
        last=point(3, 0.4, 1),
    )  # fmt: skip
    file = tmp_path / "crossing.toml"
    file.write_text(text)
    simulation, _ = build_simulation(load_scenario(file))
    for time, gone in ((0.38, False), (0.43, True)):
        simulation.advance(limit=time, pause=time, max_steps=10**7)
        state = simulation.state()
        assert gone == (not (state["body"] == 0).any())
        assert (state["body"] == 1).any()


# Deep on one side: their centres of mass are 0.15 m from the middle of the period.
DEPTHS = {"left": (0.6, 0.05), "right": (0.05, 0.6)}


def wedge(folder, dim, deep):
    """A fixed one between x = 0 and 1 with a level top."""
    left, right = DEPTHS[deep]
    corners = [[0, -left], [1, -right], [1, 0], [0, 0]]
    if dim == 2:
        return body("floor", "polygon", vertices=corners, fixed=True)
    points = [[x, y, z] for x, z in corners for y in (-1, 1)]
    trimesh.Trimesh(points).convex_hull.export(folder / "wedge.stl")
    return body("floor", "stl", file='"wedge.stl"', fixed=True)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("deep", DEPTHS)
@pytest.mark.parametrize("shape", ["ball", "block"])
def test_a_floor_is_there_over_all_of_its_period(tmp_path, dim, deep, shape):
    """Bodies cross its seam on a wedge as on a box, though its centre of mass is on one side."""
    aside = [0.0] * (dim - 2)
    low, high = [0, *[-1] * (dim - 1)], [1, *[1] * (dim - 1)]
    period = f'periodic = ["x"]\ndomain_min = {low}\ndomain_max = {high}\n\n[contact]'
    top = head([0.0, *aside, -9.8], 0.02, friction=0.2).replace("\n[contact]", period)
    floors = {
        "box": box("floor", [0, *[-1.0] * (dim - 2), -0.1], [1, *[1.0] * (dim - 2), 0], fixed=True),
        "wedge": wedge(tmp_path, dim, deep),
    }
    motion = {"velocity": [1.0, *aside, 0.0]}
    if shape == "ball":
        slider = ball("mover", [0.85, *aside, 0.03], 0.03, **motion)
    else:
        slider = box(
            "mover", [0.82, *[-0.03] * len(aside), 0], [0.88, *[0.03] * len(aside), 0.06], **motion
        )
    found = {}
    for name, floor in floors.items():
        run = started(tmp_path, top + floor + slider)
        run.advance(0.3)
        found[name] = [moving(run, "centre")[0], moving(run, "velocity")[0]]
    assert found["box"][0][0] > 1.05
    np.testing.assert_allclose(found["wedge"], found["box"], rtol=0, atol=2e-4)
