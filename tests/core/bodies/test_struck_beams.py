"""Slender bodies that are rigid until something strikes them: a blow bends them."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import ball, box, listed, started

TEXT = """
schema = 1
dim = {dim}
dp = 0.002
scheme = "resolved"
speed_max = 2
time_max = 1
time_out = 1
gravity = {gravity}

[contact]
speed = 6

[material.rock]
preset = "sandstone"
friction = 0.4
"""
HALF = {2: 0.12, 3: 0.06}  # m: a long beam, and one that a test in space can pay for
ONCE = 0.684  # m/s, at which the plane wave of Eq. (139a) has the tensile strength
THICK = 0.02  # m


def broken(folder, kinematics: str, share: float, turn: float = 0, dim: int = 2):
    """Bonds that break in a beam which falls on a post at a share of that speed."""
    angle, half = np.radians(turn), HALF[dim]
    width = [] if dim == 2 else [THICK]
    down = np.array([np.sin(angle), *[0.0] * (dim - 2), -np.cos(angle)])

    def part(name, x, y, **values):
        low, high = zip(x, *[(-w / 2, w / 2) for w in width], y, strict=True)
        return box(name, low, high, rotate=turn, pivot=[0.0] * dim, **values)

    text = TEXT.format(dim=dim, gravity=listed(0 * down))
    text += part(
        "beam", (-half, half), (0.0001, 0.0001 + THICK), material='"rock"',
        kinematics=f'"{kinematics}"', velocity=listed(share * ONCE * down),
    )  # fmt: skip
    text += ball("post", 0.02 * down, 0.02, fixed=True, material='"aluminium"')
    simulation = started(folder, text).simulation
    end = 5e-3 * half
    simulation.advance(limit=end, pause=end, max_steps=10**6)
    return simulation.totals()["broken_bonds"]


@pytest.mark.parametrize("turn", [0, 30, 90])
def test_a_beam_on_a_post_breaks_as_an_elastic_one(tmp_path, turn):
    """At speeds at which no face would crack by the plane wave alone."""
    assert broken(tmp_path, "elastic", 0.6, turn) > 10
    assert broken(tmp_path, "breakable", 0.6, turn) > 10


def test_one_that_stays_rigid_would_not_have_cracked(tmp_path):
    assert broken(tmp_path, "breakable", 0.4) == 0
    assert broken(tmp_path, "elastic", 0.4) == 0


@pytest.mark.minutes
def test_so_does_one_in_space(tmp_path):
    assert broken(tmp_path, "elastic", 0.9, dim=3) > 10
    assert broken(tmp_path, "breakable", 0.9, dim=3) > 10
