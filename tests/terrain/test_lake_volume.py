"""A box of water over a hollow: how much of it is there."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.lakes import filled_text, filled_volumes
from doseki.record.particles import FREE
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies

from .scenes import grid, text

LEVEL = 0.6
LAKE = f"""
[body.lake]
shape = "box"
material = "water"
min = [0.2, 0.2, -0.2]
max = [3.8, 3.8, {LEVEL}]
"""


@pytest.mark.parametrize("dp", [0.1, 0.08])
def test_a_bowl_is_filled_nearly_to_its_volume(tmp_path, dp):
    """But for a quarter of a spacing over the bed, and both volumes are told."""
    grid(tmp_path / "terrain.asc", lambda x, y: 0.35 * ((x - 2) ** 2 + (y - 2) ** 2))
    path = tmp_path / "case.toml"
    path.write_text(text(3, dp=dp, speed=4.0, more=LAKE))
    scenario = load_scenario(path)
    particles, _ = build_bodies(scenario)
    made = float((particles.motion == FREE).sum()) * dp**3
    exact = np.pi * LEVEL**2 / (2 * 0.35)
    bed = np.pi * LEVEL / 0.35  # of the bowl, in plan
    assert made == pytest.approx(exact - 0.25 * dp * bed, rel=0.03)
    asked, told = filled_volumes(scenario)["lake"]
    assert told == pytest.approx(made, rel=1e-9)
    assert asked == pytest.approx(exact, rel=0.01)
    assert "m3 in particles" in filled_text(asked, told, 3)
