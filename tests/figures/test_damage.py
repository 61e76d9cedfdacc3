"""Colours of damage: what may break is on the scale, whole or not, and nothing else is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib import colormaps, colors

from doseki.figures.colouring import FIXED_BESIDE_SCALE, PALE, colouring
from doseki.measure.views import whole_space
from doseki.record.particles import BOUND, FIXED, FREE


class Made(dict):
    """A snapshot of a particle each of water, a fixed wall, a stone, and two of a rock."""

    dim, grains = 2, {}

    def __init__(self):
        body = np.array(["water", "wall", "stone", "rock", "rock"])
        motion = np.array([FREE, FIXED, BOUND, BOUND, BOUND])
        super().__init__(
            body=body, id=np.arange(5), motion=motion, fixed=motion == FIXED,
            material=np.array(["water", *["sandstone"] * 4]), position=np.zeros((5, 2)),
            damage=np.array([0, 0, 0, 0.2, 0.6]),
        )  # fmt: skip


def run(kinematics):
    """Its scenario; the stone and the wall are of the rock's material, and do not break."""
    tables = {"water": {"material": "water"}, "wall": {"material": "sandstone", "fixed": True}}
    tables |= {"stone": {"material": "sandstone", "kinematics": "rigid"}}
    tables |= {"rock": {"material": "sandstone", "kinematics": kinematics}}
    materials = {"water": {"law": "fluid"}, "sandstone": {"fracture": "cohesive"}}
    return SimpleNamespace(scenario={"dim": 2, "body": tables, "material": materials})


@pytest.mark.parametrize("kinematics", ["elastic", "breakable"])
def test_what_does_not_break_is_pale_and_takes_no_part_in_the_scale(kinematics):
    found = colouring(run(kinematics), [Made()], "damage", whole_space(2))
    rgba = found.rgba(Made())
    scale = colormaps["viridis"]
    np.testing.assert_allclose(rgba[[0, 2]], [colors.to_rgba(PALE)] * 2)
    np.testing.assert_allclose(rgba[1], colors.to_rgba(FIXED_BESIDE_SCALE))
    np.testing.assert_allclose(rgba[3:], [scale(0.0), scale(1.0)])
    assert "pale" in found.heading


def test_where_nothing_breaks_all_of_it_is_on_the_scale():
    found = colouring(run("rigid"), [Made()], "damage", whole_space(2))
    assert not np.allclose(found.rgba(Made())[0], colors.to_rgba(PALE))
    assert found.heading == "damage"
