"""Bodies that are large against a period are told, as far as contacts miss some of theirs."""

from __future__ import annotations

import re

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.particles import FREE
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene

TOP = """
scheme = "resolved"
speed_max = 2
periodic = ["{axis}"]
domain_min = [0, 0]
domain_max = [{length}, {length}]
"""
BOX = """
[body.{name}]
shape = "box"
material = "basalt"
fixed = {fixed}
min = [{left}, {low}]
max = [{right}, {high}]
rotate = {rotate}
"""
DISC = """
[body.{name}]
shape = "disc"
material = "basalt"
centre = {centre}
radius = {radius}
"""


def box(name, low, high, fixed="false", rotate=0):
    (left, low), (right, high) = low, high
    return BOX.format(**locals())


def disc(name, centre, radius):
    return DISC.format(**locals())


@pytest.fixture
def told(write):
    """What is said of bodies in a square of this side, of 20 spacings or so."""

    def tell(tables: str, length: float, axis: str = "x") -> list[str]:
        path = write(TOP.format(length=length, axis=axis), tables)
        scene = build_scene(load_scenario(path, ["dp=0.05"]))
        return [text for w in scene.warnings if " period" in (text := str(w)) or "image" in text]

    return tell


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_body_that_may_turn_into_its_image_is_told(told, axis):
    """Its diagonal, 0.922 m, counts: it may come to lie along the axis."""
    long = (
        box("long", (0.05, 0.3), (0.95, 0.5))
        if axis == "x"
        else box("long", (0.3, 0.05), (0.5, 0.95))
    )
    (said,) = told(long, 0.96, axis)
    assert said == (
        "long: bodies up to 0.922 m across may touch their own images, 0.96 m away along "
        f"{axis}, which do not act on them: make the domain at least 0.972 m long there, or the "
        "bodies smaller"
    )
    assert told(long, 0.972, axis) == []


def test_a_body_that_spans_a_period_is_told_and_a_longer_one_refused(told):
    (said,) = told(box("beam", (0, 0.3), (1, 0.5)), 1)
    assert said.startswith("beam: bodies up to 1.02 m across may touch their own images, 1 m away")
    with pytest.raises(UserError, match=r"body\.beam: a body of it is 1\.1 m long along x and"):
        told(box("beam", (0, 0.3), (1.1, 0.5)), 1)


def test_a_long_body_is_refused_only_along_the_period(told):
    """Upright it has room beside itself, and may fall over into its image."""
    tall = box("tall", (0.3, -0.1), (0.7, 1.1))
    (said,) = told(tall, 1)
    assert said.startswith("tall: bodies up to 1.26 m across may touch their own images")
    with pytest.raises(UserError, match="1 m away"):
        told(box("tall", (0.3, -0.1), (0.7, 1.1), rotate=90), 1)


def test_a_ball_and_a_block_that_may_touch_on_both_sides_are_told(told):
    """The block counts with its diagonal, 0.495 m; two balls do so as they should."""
    both = disc("ball", [0.25, 0.5], 0.26) + box("block", (0.6, 0.3), (0.95, 0.65))
    (said,) = told(both, 1)
    assert said == (
        "ball: a ball of 0.52 m and one of block of 0.495 m may touch on both sides at once in a "
        "period of 1 m along x, where only the nearer side counts: make the domain at least 1.02 m "
        "long there, or the bodies smaller"
    )
    assert told(both, 1.02) == []
    assert told(disc("one", [0.25, 0.5], 0.26) + disc("other", [0.75, 1.1], 0.26), 1) == []


def test_walls_count_where_they_do_not_span_the_period(told):
    ball = disc("ball", [0.5, 0.8], 0.2)
    bed = box("bed", (0, -0.2), (1, 0), fixed="true")
    pier = box("pier", (0.2, 0), (0.85, 0.5), fixed="true")
    assert told(ball + bed, 1) == []
    (said,) = told(ball + bed + pier, 1)
    assert said.startswith(
        "ball: a ball of 0.4 m and one of pier of 0.65 m may touch on both sides"
    )
    assert told(ball + box("pier", (0.2, 0), (0.75, 0.5), fixed="true"), 1) == []


def test_nothing_is_said_of_an_open_axis(told):
    assert told(box("long", (0.3, -0.2), (0.5, 1.7)), 2.5) == []


def test_the_remedy_is_one(told):
    """What is said to be long enough is long enough, however it is rounded."""
    rng = np.random.default_rng(1)
    for radius in rng.uniform(0.2501, 0.2999, 5):
        both = disc("ball", [0.3, 0.5], radius) + box("block", (0.5, 1), (0.9, 1.4))
        (said,) = told(both, 1)
        assert told(both, float(said.split("at least ")[1].split()[0])) == []


@pytest.mark.parametrize("axis", ["x", "y"])
def test_bodies_that_overlap_across_the_end_of_a_period_are_refused(told, axis):
    """A disc at one end and, at the other, a disc, a box or a wall."""

    def at(along, across):
        return [along, across] if axis == "x" else [across, along]

    first = disc("first", at(0.05, 0.5), 0.12)
    second = disc("second", at(0.85, 0.5), 0.12)
    others = {
        "second": second,
        "block": box("block", at(0.7, 0.4), at(0.95, 0.6)),
        "wall": box("wall", at(0.8, 0.3), at(0.95, 0.7), fixed="true"),
    }
    for name, other in others.items():
        with pytest.raises(UserError, match=r"overlaps .* by 0\.0") as said:
            told(first + other, 1, axis)
        assert {"first", name} <= set(re.findall(r"\w+", str(said.value)))
        assert not any("overlap" in text for text in told(first + other, 1.3, axis))


WEDGE = """
[body.sea]
shape = "box"
material = "water"
min = [0, 0]
max = [2, 2]

[body.wedge]
shape = "polygon"
material = "basalt"
fixed = true
vertices = [[0, 0], [2, 0], [2, {right}], [0, {left}]]
"""


@pytest.mark.parametrize(("left", "right"), [(1.5, 0.1), (0.1, 1.5)])
def test_water_makes_room_for_all_of_a_wedge_that_spans_the_period(write, left, right):
    """Its centre of mass is 0.29 m from the middle of the period."""
    path = write(TOP.format(length=2, axis="x"), WEDGE.format(left=left, right=right))
    particles = build_scene(load_scenario(path, ["dp=0.05"])).particles
    x, y = particles.position[particles.motion == FREE].T
    assert len(x) > 500
    assert (y > np.interp(x, [0, 2], [left, right])).all()
