"""Grains under a fixed bed: cohesive as printed, in free fall once tension is taken away."""

from __future__ import annotations

import numpy as np
import pytest

from ..cases import Case

FALL_TIME = 0.3
FREE_FALL = 0.5 * 9.8 * FALL_TIME**2


def drop(*overrides):
    """How far the grains have fallen on average after FALL_TIME, m."""
    case = Case("hang", *overrides)
    start = case.mean("position", "grains")[-1]
    case.advance(FALL_TIME)
    return start - case.mean("position", "grains")[-1]


@pytest.mark.parametrize("tension", ["clamp_fluid", "clamp_all"])
def test_grains_with_strength_stick(tension, report):
    """Clamping the pressure does not help: the deviatoric stress pulls as well."""
    fallen = drop("strength=true", f"tension={tension}")
    report("drop", fallen, "below 1e-4", "m")
    assert abs(fallen) < 1e-4


def test_grains_without_strength_hang_by_their_tension(report):
    """Negative pressure alone holds them."""
    fallen = drop("strength=false", "tension=clamp_fluid")
    report("drop", fallen, "below 1e-3", "m")
    assert 0 < fallen < 1e-3


@pytest.mark.parametrize("dim", [2, pytest.param(3, marks=pytest.mark.validate)])
def test_grains_without_strength_and_tension_fall_freely(dim, report):
    fallen = drop(f"dim={dim}", "strength=false", "tension=clamp_all")
    report("drop", fallen, FREE_FALL, "m")
    assert fallen == pytest.approx(FREE_FALL, rel=1e-3)


def test_rows_of_falling_grains_keep_their_distance():
    """Nothing acts between grains that fall together."""
    case = Case("hang", "strength=false", "tension=clamp_all")
    grains = case.body_names.index("grains")
    heights = []
    for time in (0.0, 0.1):
        state = case.advance(time)
        heights.append(np.ptp(state["position"][state["body"] == grains][:, 1]))
    assert heights[1] == pytest.approx(heights[0], rel=1e-3)
