"""Maps of whole metres: slopes of treads and risers are told, and no depth is read from them."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.estimates import flow_depths
from doseki.geodata.raster import Raster
from doseki.scenario.load import load_scenario
from doseki.scenario.terraces import terraces_of
from doseki.scene.checks.terrain import Terraced, terrain_findings
from doseki.solver.build import filled_simulation

from .scenes import grid, text

SLIDE = """
[body.slide]
shape = "release"
material = "water"
polygon = [[10, 20], [40, 20], [40, 60], [10, 60]]
thickness = 5
"""


def valley(x, y):
    return 300 + 0.47 * (100 - x) + 15 * ((y - 40) / 40) ** 2


def raster(height, cell=2.0, size=(100.0, 80.0)):
    x, y = ((np.arange(round(side / cell)) + 0.5) * cell for side in size)
    return Raster(height(*np.meshgrid(x, y))[::-1], 0.0, 0.0, cell)


@pytest.fixture
def scenario(tmp_path):
    """A function that loads a release of 2.5 particles on a map of some heights."""

    def load(height, *settings):
        grid(tmp_path / "terrain.asc", height, (100.0, 80.0), 2.0)
        (tmp_path / "case.toml").write_text(text(3, dp=2, speed=30, more=SLIDE))
        return load_scenario(tmp_path / "case.toml", list(settings))

    return load


def told(scenario):
    return [str(each) for each in terrain_findings(scenario, {}) if isinstance(each, Terraced)]


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_a_map_in_steps_is_told_with_what_evens_them_out(scenario, step):
    def height(x, y):
        return step * np.round(valley(x, y) / step)

    assert told(scenario(valley)) == []
    (said,) = told(scenario(height))
    assert said.startswith(f"terrain.file: its heights come in steps of {step:g} m")
    assert "terrain.smoothing = 4 evens them out, and with them what is narrower" in said
    assert len(told(scenario(height, "terrain.smoothing=1"))) == 1
    assert told(scenario(height, "terrain.smoothing=4")) == []
    assert told(scenario(height, "dp=12")) == []


def test_no_depth_is_read_from_tread_to_riser(scenario):
    depth = {}
    for name, height in {"smooth": valley, "steps": lambda x, y: np.round(valley(x, y))}.items():
        case = scenario(height)
        simulation, names, _ = filled_simulation(case)
        simulation.start()
        depth[name] = flow_depths(case, simulation.state(), dict(enumerate(names)))["slide"]
    assert depth["smooth"] == pytest.approx(2.4, abs=0.2)
    assert 0.8 * depth["smooth"] < depth["steps"] < depth["smooth"]


@pytest.mark.parametrize(
    "height",
    [
        lambda x, y: valley(x, y),
        lambda x, y: 0.01 * np.round(100 * (valley(x, y) + np.sin(x) + np.sin(2 * y))),
        lambda x, y: 100 - 0.5 * (x - 1) + 0 * y,  # a plane
        lambda x, y: 1.0 * (abs(y - 40) > 20),  # a floor with walls
        lambda x, y: 0 * x,
        lambda x, y: np.round(20 * np.sin(x) * np.cos(1.3 * y)),  # rough ground
    ],
    ids=["smooth", "centimetres", "plane", "flume", "flat", "rough"],
)
def test_other_ground_has_no_steps(height):
    assert terraces_of(raster(height)) is None


def test_gentle_slopes_are_smoothed_over_half_a_tread():
    found = terraces_of(raster(lambda x, y: np.round(300.2 - 0.05 * x + 0 * y), size=(400.0, 20.0)))
    assert found.step == 1
    assert found.length == pytest.approx(10, rel=0.1)
