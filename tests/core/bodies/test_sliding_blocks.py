"""Blocks that slide: points of the bed at their edges, and seams of it, do not hold them."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import box, head, moving, started

G, ANGLE, FRICTION, SIDE = 9.81, np.radians(25), 0.3, 0.1
# s: friction has stretched its spring at first; until the end it goes for a sixth of its side
BEGIN, TIME = 0.03, 0.15


def speed(folder, across, place, *, dim=2, direction=1, seam=None):
    """What a block on a dry slope gains from BEGIN to TIME, over that of the closed form.

    `place`: of its middle against the points of the bed, spacings. `seam`: of two beds, so far
    ahead of its middle, m.
    """
    dp, sides = SIDE / across, [0.3] * (dim - 2)
    gravity = [direction * G * np.sin(ANGLE), *[0.0] * (dim - 2), -G * np.cos(ANGLE)]
    end = seam * direction if seam else 0.5
    ways = [("bed", *sorted((-0.5 * np.sign(end), end)))]
    if seam:
        ways.append(("more", *sorted((end, 0.5 * direction))))
    text = head(gravity, dp, friction=FRICTION)
    for name, first, last in ways:
        low, high = [float(first), *[-x for x in sides], -3 * dp], [float(last), *sides, 0.0]
        text += box(name, low, high, fixed=True)
    half = [SIDE / 2] * (dim - 2)
    low = [place * dp - SIDE / 2, *[-x for x in half], 0.0]
    text += box("block", low, [place * dp + SIDE / 2, *half, SIDE])
    run = started(folder, text)
    before, after = velocity(run, BEGIN), velocity(run, TIME)
    exact = G * (np.sin(ANGLE) - FRICTION * np.cos(ANGLE)) * (TIME - BEGIN)
    assert abs(after[-1]) < 1e-3 * exact
    return float(direction * (after - before)[0] / exact)


def velocity(run, time):
    run.advance(time)
    return moving(run, "velocity")[0]


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("across", "place"), [(6, 0.0), (6, 0.25), (10, 0.5), (10, 0.0)])
@pytest.mark.parametrize("seam", [None, 0.02, 0.052])
def test_a_block_slides_wherever_it_lies_on_the_points_of_its_bed(
    tmp_path, across, place, direction, seam
):
    """The normals of its sides would take up to 6 % of its speed."""
    found = speed(tmp_path, across, place, direction=direction, seam=seam)
    assert found == pytest.approx(1, abs=0.003)


@pytest.mark.parametrize("seam", [0.02, 0.052])
def test_a_block_slides_over_a_seam_in_space(tmp_path, seam):
    """One of 10 across stopped there when its edge came to it."""
    assert speed(tmp_path, 10, 0.0, dim=3, seam=seam) == pytest.approx(1, abs=0.003)
