"""A polygon of many sides is round: what meets it does not meet edges."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.running import CASES

DISC = (CASES / "grains" / "disc-array.toml").read_text()


def polygon(sides: int) -> str:
    """The array of discs with polygons of the same area in their place."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    radius = 0.005 * np.sqrt(2 * np.pi / (sides * np.sin(2 * np.pi / sides)))
    corners = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    text = DISC
    for old, new in (
        ('shape = "disc"', 'shape = "polygon"'),
        ("centre = [0, 0]\n", ""),
        ('radius = "= d/2"', f"vertices = {corners.tolist()}"),
    ):
        assert old in text
        text = text.replace(old, new)
    return text


def mean_speed(flows, text: str) -> float:
    """Of a slow stream through the array, along it."""
    simulation = flows(text, "across=8")
    simulation.advance(limit=0.2, pause=0.2, max_steps=10**9)
    state = simulation.state()
    return float(state["velocity"][state["motion"] == 0][:, 0].sum())


@pytest.mark.minutes
def test_it_has_the_drag_of_a_disc(flows):
    speeds = [mean_speed(flows, polygon(sides)) for sides in (12, 24)]
    assert speeds == pytest.approx([mean_speed(flows, DISC)] * 2, rel=0.04)
