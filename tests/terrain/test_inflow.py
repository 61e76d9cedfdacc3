"""A hydrograph into a channel of a map: what of its section lies above the ground carries it."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.inflow_sections import build_inflows
from doseki.solver.build import filled_simulation

from .scenes import fluid, grid, text

INFLOW = """
[inflow.flood]
material = "water"
hydrograph = [[0, 0.2], [0.5, 0.5], [2, 0.5]]
position = [1.0, 0.5, 1.2]
direction = [1, 0, -0.2]
width = 3.0
depth = 1.2
"""


def channel(x, y):
    """A V-shaped channel that falls by 0.2 along x."""
    return 2 - 0.2 * x + 0.5 * np.abs(y - 2)


@pytest.fixture
def path(tmp_path):
    grid(tmp_path / "terrain.asc", channel)
    file = tmp_path / "case.toml"
    file.write_text(text(3, dp=0.1, time=1.0, speed=5.0, more=INFLOW))
    return file


def test_the_section_is_cut_by_the_channel(path):
    (section,) = build_inflows(load_scenario(path), ["terrain", "flood"])
    height = section.rows[:, 2] - channel(*section.rows[:, :2].T)
    assert height.min() > 0.04
    steep = np.sqrt(1 + 0.2**2 + 0.5**2)
    assert height.min() < 1.5 * 0.1 * steep
    area = len(section.rows) * 0.01
    assert section.speeds.max() == pytest.approx(0.5 / area)
    _, _, warnings = filled_simulation(load_scenario(path))
    (said,) = [str(each) for each in warnings if each.place == "inflow.flood"]
    assert f"{len(section.rows)} of 360 particles of a layer lie above the ground" in said


def test_the_discharge_enters_and_stays_on_the_ground(path):
    simulation, _, _ = filled_simulation(load_scenario(path))
    simulation.start()
    simulation.advance(limit=1.0, pause=1.0, max_steps=10**6)
    totals, state = simulation.totals(), simulation.state()
    assert totals["mass_asked"] == pytest.approx(1000 * (0.5 * 0.35 + 0.5 * 0.5), rel=1e-9)
    layer = 10 * len(build_inflows(load_scenario(path), ["terrain", "flood"])[0].rows) * 0.1
    assert totals["mass_entered"] == pytest.approx(totals["mass_asked"], abs=layer)
    position = state["position"][fluid(state)]
    assert (position[:, 2] > channel(position[:, 0], position[:, 1]) - 0.05).all()
    assert position[:, 0].max() > 1.3


def test_one_that_lies_in_the_ground_is_refused(path):
    deep = load_scenario(path, ["inflow.flood.position=[1.0, 0.5, -2]"])
    with pytest.raises(UserError, match="all of its section lies in the ground"):
        filled_simulation(deep)
