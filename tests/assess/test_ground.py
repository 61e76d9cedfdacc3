"""What `check` and the trust report say of the ground of a terrain."""

from __future__ import annotations

import re
import time
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from doseki.assess.cost import estimate
from doseki.assess.ground import sliding
from doseki.assess.ground.pits import narrow_pits, pit_depths
from doseki.assess.ground.sliding import Sliding, swept_ground
from doseki.assess.ground.spreading import ground_to_come
from doseki.assess.preflight import check_scenario
from doseki.assess.trust.ground import ground_check
from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

HEAD = """
dim = 3
dp = {dp}
time_max = {time}
time_out = {time}
scheme = "resolved"
gravity = [0, 0, -9.81]
speed_max = 6
[terrain]
file = "map.asc"
material = "basalt"
wall = "voellmy"
mu = 0.1
"""
SLIDE = """
[body.slide]
shape = "release"
material = "water"
polygon = [[1, 1.5], [2, 1.5], [2, 2.5], [1, 2.5]]
thickness = 0.3
"""
MUD = (
    SLIDE.replace("water", "mud").replace("0.3", "0.6")
    + """
[material.mud]
based_on = "water"
rho0 = 1900
nu = 0.05
"""
)
SURGE = """
[inflow.flood]
material = "water"
surge = [[0, 0, 2], [1, 0.3, 2]]
position = [2, 1.5, 5]
direction = [1, 0, -0.4]
width = 1
"""
DAM = """
[body.dam]
shape = "box"
material = "basalt"
fixed = true
min = [8, 1, 4]
max = [10, 3, 6]
"""
LAKE = """
[body.lake]
shape = "box"
material = "water"
min = [0.3, 0.3, -0.05]
max = [4.1, 4.1, 0.4]
"""


def run_with(through: float | None, **scenario: Any) -> Any:
    """A run of 200 kg, of which so much went through the ground."""
    said = {"mass_initial": 150.0, "mass_entered": 50.0}
    if through is not None:
        said["mass_through_ground"] = through
    return cast(Any, SimpleNamespace(summary=said, scenario=scenario))


@pytest.mark.parametrize(("through", "verdict"), [(0, "good"), (0.1, "doubtful"), (20, "bad")])
def test_mass_that_went_through_the_ground_is_judged(through, verdict):
    check, left = ground_check(run_with(through, terrain={"file": "map.tif"}))
    assert left.verdict == "good"
    assert check.verdict == verdict
    assert check.value == pytest.approx(through / 200)
    assert ("speed_max" in check.remedy) is (verdict != "good")


def test_runs_without_a_terrain_or_the_number_are_not_judged():
    assert ground_check(run_with(0.0)) == []
    assert ground_check(run_with(None, terrain={"file": "map.tif"})) == []


@pytest.fixture
def started(tmp_path):
    """A started simulation on a map of heights (function of x, y): a function of these."""

    def start(height, bodies, size=(12.0, 4.0), cell=0.1, dp=0.1, time=2.0):
        x, y = ((np.arange(round(side / cell)) + 0.5) * cell for side in size)
        values = height(*np.meshgrid(x, y))[::-1]
        write_raster(tmp_path / "map.asc", Raster(values, 0.0, 0.0, cell))
        path = tmp_path / "case.toml"
        path.write_text(HEAD.format(dp=dp, time=time) + bodies)
        scenario = load_scenario(path)
        simulation, names, _ = filled_simulation(scenario)
        simulation.start()
        return scenario, simulation, names

    return start


def slope(x, y):
    return 6 - 0.4 * x + 0 * y


def valley(x, y):
    return 6 - 0.4 * x + 0.3 * (y - 2) ** 2


def test_ground_that_comes_with_a_flow_is_expected(started):
    """A slide of 340 particles has twice as many below it after 2 s, in which it goes 5 m."""
    scenario, simulation, names = started(valley, MUD)
    expected = estimate(scenario, simulation, names)
    simulation.advance(limit=2.0, pause=2.0, max_steps=10**6)
    assert len(simulation) > 1.2 * expected.particles
    assert expected.most_particles == pytest.approx(len(simulation), rel=0.3)
    assert expected.scattered >= expected.ground > 0


def test_what_scatters_has_more_ground_but_no_more_than_told(started):
    """Thin water on an open slope: single particles, each with ground of its own."""
    scenario, simulation, names = started(slope, SLIDE)
    expected = estimate(scenario, simulation, names)
    simulation.advance(limit=2.0, pause=2.0, max_steps=10**6)
    more = len(simulation) - expected.particles
    assert expected.ground < more < 1.3 * expected.scattered


def test_other_fixed_bodies_are_no_ground(started):
    """A slide brings as much ground where a dam of 8000 particles stands below."""
    times = np.linspace(0.0, 2.0, 11)
    expected = []
    for bodies in (MUD, MUD + DAM):
        scenario, simulation, names = started(slope, bodies)
        at_start = Sliding(scenario, simulation.state(), names)
        expected.append(ground_to_come(at_start, times, np.zeros(len(times))))
    (ground, most), (with_dam, most_with_dam) = expected
    assert ground.max() > 100
    np.testing.assert_array_equal(with_dam, ground)
    assert most_with_dam == most


def test_check_tells_of_ground_that_comes(started):
    scenario, *_ = started(valley, MUD)
    (said,) = [
        line
        for line in check_scenario(scenario, threads=1).splitlines()
        if line.startswith("most particles")
    ]
    assert re.search(r"about [\d,]+, if nothing leaves: ground comes where the flow spreads", said)


def test_a_surge_brings_what_its_layers_have(started):
    """Layers of a surge are as high as it is thick: half of the rows, in the mean."""
    scenario, simulation, names = started(slope, SURGE, time=1.0)
    expected = estimate(scenario, simulation, names)
    entered = expected.most_particles - expected.ground - expected.particles
    assert entered == pytest.approx(0.5 * 0.3 * 1.0 * 2.0 / 0.1**3, rel=0.25)


def test_no_ground_comes_with_a_lake_or_a_short_run(started):
    def bowl(x, y):
        return 0.3 * ((x - 2.2) ** 2 + (y - 2.2) ** 2)

    for bodies, height, size, end, most in (
        (LAKE, bowl, (4.4, 4.4), 2.0, 1.25),
        (SLIDE, slope, (12.0, 4.0), 0.02, 1.1),
    ):
        expected = estimate(*started(height, bodies, size, time=end))
        assert expected.most_particles < most * expected.particles


def test_points_slide_downhill_and_stop_by_friction(started):
    scenario, simulation, names = started(slope, SLIDE, time=1.0)
    swept = swept_ground(scenario, simulation.state(), names)
    along = 0.5 * 9.81 * (0.4 - 0.1) / (1 + 0.4**2)  # of a point that starts from rest, m
    spread = np.sqrt(2 * 9.81 * 0.36)
    assert 2.0 + along < swept.place[:, 0].max() < 2.2 + along + spread
    assert swept.place[:, 0].min() > 1.0 - spread
    assert swept.more(np.array([0.0]))[0] == 0 < swept.more(np.array([1.0]))[0]


def test_the_columns_of_many_particles_are_found_at_once():
    """A million in a third of a second; rows sorted as such took five."""
    place = np.random.default_rng(5).random((10**6, 2)) * [100.0, 40.0] - 20.0
    began = time.process_time()
    cell = sliding._cell(place, 0.1)
    assert time.process_time() - began < 1.5
    columns = [len(np.unique(np.floor(place / side), axis=0)) for side in (cell, cell / 2)]
    assert columns[0] <= sliding.MAX_CELLS < columns[1]


def test_a_check_slides_points_once(started, monkeypatch):
    """For the ground that comes, and for pits."""
    calls = []

    def counted(*about):
        calls.append(about)
        return swept_ground(*about)

    monkeypatch.setattr(sliding, "swept_ground", counted)

    def rough(x, y):
        return slope(x, y) + 0.06 * np.random.default_rng(7).standard_normal(x.shape)

    scenario, *_ = started(rough, SLIDE, cell=0.2)
    assert "pits that particles do not fill" in check_scenario(scenario, threads=1)
    assert len(calls) == 1


@pytest.mark.parametrize(("noise", "smooth", "told"), [(0.6, 0, True), (0.24, 0, False),
                                                       (0.6, 1, False)])  # fmt: skip
def test_pits_that_particles_do_not_fill_are_told(started, noise, smooth, told):
    """Of heights that vary by 0.6 dp from node to node, two dp apart, a lake loses particles."""
    dp = 0.1

    def bowl(x, y):
        rough = noise * dp * np.random.default_rng(7).standard_normal(x.shape)
        return 0.06 * ((x - 4.4) ** 2 + (y - 4.4) ** 2) + rough

    bodies = LAKE.replace("4.1", "8.5").replace("-0.05", "-0.5")
    if smooth:
        bodies = f"smoothing = {2 * dp}\n" + bodies
    scenario, simulation, names = started(bowl, bodies, (8.8, 8.8), cell=2 * dp, dp=dp)
    found = [str(each) for each in narrow_pits(Sliding(scenario, simulation.state(), names))]
    assert len(found) == told
    if told:
        assert "pits that particles do not fill" in found[0]
        assert "terrain.smoothing = 0.2, or lower dp" in found[0]


def test_bends_and_slopes_are_no_pits():
    x = np.arange(40) * 0.1
    bend, pit = np.maximum(1 - x, 4 * (x - 2)), 0.0 * x
    pit[20] = -1.0
    assert pit_depths(bend).max() < 1e-12
    assert pit_depths(pit)[20] == 1.0
    valley = np.abs(x - 2)[None, :] + 0.3 * x[:, None]
    assert pit_depths(valley).max() == pytest.approx(0.0, abs=1e-12)
    valley[10, 20] -= 0.5
    assert pit_depths(valley)[10, 20] == pytest.approx(0.5, abs=1e-12)
