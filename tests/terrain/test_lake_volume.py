"""Water over a hollow and a release on a slope: how much of it is in the run."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.ground.volumes import volume_lines, volumes_at_start
from doseki.assess.lakes import filled_volumes
from doseki.record.particles import FREE
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies, build_scene

from .scenes import grid, simulation_of, text

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
    line = volume_lines({"filled": {"lake": [asked, told]}}, 3)["lake"]
    assert "m3 in particles" in line
    assert "other bodies" not in line


RELEASE = """
[body.debris]
shape = "release"
material = "water"
polygon = [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]]
thickness = 0.5
"""
HOUSE = """
[body.house]
shape = "box"
material = "basalt"
fixed = true
min = [1.5, 1.5, -2.0]
max = [{east}, 2.5, 2.0]
"""
BOXED = """
[body.lake]
shape = "box"
material = "water"
min = [1.0, 1.0, -1.0]
max = [3.0, 3.0, 0.5]
"""


def told(folder, body, house):
    """The line about a body beside a house, and what is doubtful about its room."""
    grid(folder / "terrain.asc", lambda x, y: 0 * x)
    path = folder / "case.toml"
    path.write_text(text(3, dp=0.1, speed=4.0, more=body + house))
    scenario = load_scenario(path)
    simulation, names = simulation_of(path)
    table = volumes_at_start(scenario, simulation.state(), names).table
    doubts = [str(d) for d in build_scene(scenario).warnings if "inside fixed" in str(d)]
    return table, volume_lines(table, 3), doubts


@pytest.mark.parametrize(("body", "name"), [(RELEASE, "debris"), (BOXED, "lake")])
@pytest.mark.parametrize(("east", "warned"), [(2.5, True), (1.6, False)])
def test_what_a_house_takes_is_not_in_the_run(tmp_path, body, name, east, warned):
    """A quarter of it is told and warned of; a twentieth part or less is told."""
    table, lines, doubts = told(tmp_path, body, HOUSE.format(east=east))
    taken = (east - 1.5) * 1.0 * 0.5
    ((asked, inside),) = (table.get("released") or table["filled"]).values()
    assert asked == pytest.approx(2.0, rel=0.01)
    assert inside == pytest.approx(2.0 - taken, rel=0.01)
    assert table["taken"][name] == pytest.approx(taken, rel=0.02)
    assert lines[name].endswith(f"of which {taken:.4g} m3 lie inside other bodies")
    assert bool(doubts) == warned
    assert (
        not warned
        or "25 % of it lies inside fixed bodies, most of that inside body.house" in (doubts[0])
    )


@pytest.mark.parametrize("body", [RELEASE, BOXED])
def test_a_house_beside_them_takes_nothing(tmp_path, body):
    house = HOUSE.format(east=3.6).replace("[1.5, 1.5", "[3.05, 1.5")
    table, lines, doubts = told(tmp_path, body, house)
    assert "taken" not in table
    assert not doubts
    assert all("other bodies" not in line for line in lines.values())


def test_the_summary_tells_what_is_in_the_run(tmp_path):
    """Also once fluid has left: it tells of the start."""
    grid(tmp_path / "terrain.asc", lambda x, y: 0 * x)
    path = tmp_path / "case.toml"
    path.write_text(text(3, dp=0.1, speed=4.0, more=RELEASE + HOUSE.format(east=2.5)))
    scenario = load_scenario(path, ["time_max=0.01", "time_out=0.01"])
    summary = run_scenario(scenario, tmp_path / "run", RunOptions(1))
    assert summary["released"]["debris"] == pytest.approx([2.0, 1.5], rel=0.01)
    assert summary["mass_initial"] == pytest.approx(1.5 * 1000, rel=0.01)
    said = (tmp_path / "run/summary.txt").read_text()
    assert "of which 0.5 m3 lie inside other bodies" in said
    assert load(tmp_path / "run").summary["taken"]["debris"] == pytest.approx(0.5, rel=0.02)
