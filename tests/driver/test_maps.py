"""Maps that a run keeps: when they look, what they write, and how they go on."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.run.channel import run_channel

from doseki.assess.summary import summary_text
from doseki.driver.maps import RunningMaps
from doseki.driver.ranks import OneRank
from doseki.errors import PhysicsError, UserError
from doseki.figures.plot import draw_run
from doseki.geodata.raster import Raster, read_raster, write_raster
from doseki.measure.maps.grid import MapSettings, map_grid
from doseki.measure.maps.snapshots import maps_from_snapshots
from doseki.record.folder import RunFolder
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

WEST, SOUTH = 460_000, 5_200_000
COLLAPSE = f"""\
dim = 3
scheme = "resolved"
speed_max = 3
dp = 0.05
time_max = 0.12
time_out = 0.06
title = "collapse"
gravity = [0, 0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [{WEST}, {SOUTH}, -0.15]
max = [{WEST + 1}, {SOUTH + 0.5}, 0]

[body.water]
shape = "box"
material = "water"
min = [{WEST + 0.1}, {SOUTH + 0.1}, 0]
max = [{WEST + 0.4}, {SOUTH + 0.4}, 0.3]
jitter = 0.1

[maps]
interval = 0.01
cell = 0.1
extent = [{WEST}, {SOUTH}, {WEST + 1}, {SOUTH + 0.5}]
"""
NAMES = (
    "peak_depth", "peak_speed", "peak_pressure", "peak_total_pressure", "peak_momentum_flux",
    "peak_travel_angle", "arrival_time", "deposit",
)  # fmt: skip


DAM = f"""
[material.rubber]
based_on = "basalt"
young_modulus = 1e7

[body.dam]
shape = "box"
kinematics = "elastic"
material = "rubber"
min = [{WEST + 0.6}, {SOUTH}, 0]
max = [{WEST + 0.8}, {SOUTH + 0.5}, 0.2]
clamped = "= 0.06 - z"
"""


@pytest.fixture(scope="module")
def collapse(tmp_path_factory):
    """The scenario file."""
    file = tmp_path_factory.mktemp("collapse") / "collapse.toml"
    file.write_text(COLLAPSE)
    return file


@pytest.fixture(scope="module")
def straight(collapse):
    """The folder of a run from beginning to end."""
    run_channel(collapse, collapse.parent / "straight")
    return collapse.parent / "straight"


def maps_in(folder):
    return {name: (folder / f"maps/{name}.asc").read_bytes() for name in NAMES}


def stop_at(folder, time):
    return lambda now, _dt, _step: (folder / "STOP").touch() if now >= time else None


def test_the_maps_of_a_run(straight):
    """Against the snapshots, which see less; the start is exact."""
    maps = {name: read_raster(straight / f"maps/{name}.asc") for name in NAMES}
    depth = maps["peak_depth"].values
    assert maps["peak_depth"].extent == (WEST, SOUTH, WEST + 1, SOUTH + 0.5)
    np.testing.assert_allclose(depth[1:4, 1:4], 0.3, rtol=0.05)  # jitter moves some out
    arrival = maps["arrival_time"].values
    assert (arrival[1:4, 1:4] == 0).all()
    assert np.nanmax(arrival) > 0
    times = arrival[~np.isnan(arrival)] / 0.01
    np.testing.assert_allclose(times, np.round(times), atol=1e-9)
    speed, pressure = maps["peak_speed"].values, maps["peak_pressure"].values
    assert speed.max() > 0.5
    np.testing.assert_allclose(pressure[speed > 0], 1000 * speed[speed > 0] ** 2, rtol=0.05)
    total = maps["peak_total_pressure"].values
    assert total[2, 2] >= 0.9 * 1000 * 9.8 * 0.3


def test_the_summary_on_one_screen(collapse, tmp_path):
    section = f"""
[gauge.line]
kind = "section"
left = [{WEST + 0.4}, {SOUTH + 0.5}]
right = [{WEST + 0.4}, {SOUTH}]
interval = 0.01
"""
    file = tmp_path / "section.toml"
    file.write_text(COLLAPSE + section)
    run_channel(file, tmp_path / "run", "time_max=0.04")
    run = load(tmp_path / "run")
    lines = {line[:18].strip(): line[18:] for line in summary_text(run).splitlines()}
    assert lines["section line"].startswith("flow from 0 s on, peak ")
    assert lines["maps"].startswith(f"covered {run.summary['runout']['area']:.4g} m2; ")
    assert run.gauges["line"]["discharge"][-1] > 0


def test_a_run_that_fails_leaves_its_maps(collapse, tmp_path):
    with pytest.raises(PhysicsError):
        run_channel(collapse, tmp_path / "run", "body.water.velocity=[1e6, 0, 0]")
    assert load(tmp_path / "run").summary["status"] == "failed"
    assert read_raster(tmp_path / "run/maps/peak_depth.asc").values.max() > 0.2


def test_figures_have_the_maps(straight):
    drawn = draw_run(straight)
    assert straight / "maps/peak_depth.png" in drawn.pictures
    assert any("deposit is not drawn" in note for note in drawn.notes)
    assert drawn.failures == []


def test_the_summary_tells_the_area(straight):
    said = load(straight).summary["runout"]
    depth = read_raster(straight / "maps/peak_depth.asc").values
    assert said["area"] == pytest.approx(np.count_nonzero(depth) * 0.01)
    assert json.loads((straight / "summary.json").read_text())["status"] == "done"


def test_a_run_that_was_stopped_has_the_maps_of_one_that_was_not(collapse, straight, tmp_path):
    run = tmp_path / "run"
    options = {"checkpoint_every": 0.001}
    summary = run_channel(collapse, run, progress=stop_at(run, 0.025), **options)
    assert summary["status"] == "stopped"
    early = maps_in(run)
    assert early != maps_in(straight)
    summary, _ = resume_run(run, (), RunOptions(1, progress=stop_at(run, 0.0777), **options))
    assert summary["status"] == "stopped"
    assert resume_run(run, (), RunOptions(threads=1))[0]["status"] == "done"
    assert maps_in(run) == maps_in(straight)
    for file in sorted((straight / "snapshots").iterdir()):
        assert (run / "snapshots" / file.name).read_bytes() == file.read_bytes()


def test_a_checkpoint_of_other_maps_is_refused(collapse, tmp_path):
    run = tmp_path / "run"
    run_channel(collapse, run, progress=stop_at(run, 0.025))
    with pytest.raises(UserError, match="maps cannot change"):
        resume_run(run, ["maps.cell=0.25"], RunOptions(threads=1))


def test_the_steps_end_at_looks(collapse, straight, tmp_path):
    """Without maps there are fewer steps: each look ends one."""
    text = collapse.read_text().partition("[maps]")[0]
    (tmp_path / "none.toml").write_text(text)
    without = run_channel(tmp_path / "none.toml", tmp_path / "none")
    assert not (tmp_path / "none/maps").exists()
    assert "runout" not in without
    assert load(straight).summary["step"] > without["step"]


def test_a_terrain_in_the_folder_gives_the_cells(collapse, tmp_path):
    """Its heights too: the weight on a slope is less. Nothing has run out at the first look."""
    scenario = load_scenario(collapse)
    simulation, _, _ = filled_simulation(scenario)
    simulation.start()
    found = {}
    for slope in (0.0, 1.0):
        folder = tmp_path / f"slope-{slope}"
        folder.mkdir()
        terrain = Raster(np.zeros((20, 40)), WEST - 0.5, SOUTH - 0.25, 0.05, nodata=-1.0)
        heights = np.tile(100 - slope * (terrain.x - WEST), (20, 1))
        write_raster(folder / "terrain.asc", terrain.with_values(heights))
        maps = RunningMaps(scenario, list(scenario.body), RunFolder(folder), OneRank())
        maps.look(simulation)
        maps.write(simulation)
        found[slope] = read_raster(folder / "maps/peak_total_pressure.asc")
    assert found[1.0].extent == pytest.approx((WEST, SOUTH, WEST + 1, SOUTH + 0.5))
    assert found[1.0].cell == 0.1
    ratio = found[1.0].values[2, 2] / found[0.0].values[2, 2]
    assert ratio == pytest.approx(0.5)  # cos2 of 45 degrees
    assert maps.runout["top"][2] == pytest.approx(99.85)
    assert maps.runout["toe"] is None


def test_an_overwritten_run_leaves_no_maps(collapse, tmp_path):
    run_channel(collapse, tmp_path / "run", "time_max=0.01")
    (tmp_path / "run/terrain.asc").write_text("of the earlier run")
    text = collapse.read_text().partition("[maps]")[0]
    (tmp_path / "none.toml").write_text(text)
    scenario = load_scenario(tmp_path / "none.toml", ["time_max=0.01"])
    run_scenario(scenario, tmp_path / "run", RunOptions(1, overwrite=True))
    assert not list((tmp_path / "run/maps").iterdir())
    assert not (tmp_path / "run/terrain.asc").exists()


def test_what_is_beside_the_map_is_told(collapse, tmp_path):
    extent = f"[{WEST}, {SOUTH}, {WEST + 0.3}, {SOUTH + 0.5}]"
    summary = run_channel(collapse, tmp_path / "run", "time_max=0.01", f"maps.extent={extent}")
    (said,) = (text for text in summary["warnings"] if text.startswith("maps"))
    assert "beside the map" in said


def test_small_cells_are_warned_of(collapse, tmp_path):
    summary = run_channel(collapse, tmp_path / "run", "time_max=0.01", "maps.cell=0.0625")
    assert any("maps.cell = 0.1" in text for text in summary["warnings"])


@pytest.mark.parametrize(
    ("setting", "word"),
    [
        ("maps.cell=0.01", "smaller than a particle"),
        ("maps.extent=[1, 1, 0, 2]", "west < east"),
        ("maps.extent=[0, 0, 1]", "4 entries"),
        ("maps.interval=0", "interval"),
        ("maps.interval=1e-9", "too short"),
        ("maps.intervall=0.1", "did you mean"),
    ],
)
def test_wrong_maps_are_refused(collapse, tmp_path, setting, word):
    with pytest.raises(UserError, match=word):
        run_channel(collapse, tmp_path / "run", setting)


def test_without_a_grid_maps_are_refused(collapse, tmp_path):
    text = collapse.read_text().partition("extent =")[0]
    (tmp_path / "none.toml").write_text(text)
    with pytest.raises(UserError, match=r"maps\.extent is missing: the run has no terrain"):
        run_channel(tmp_path / "none.toml", tmp_path / "run")


def test_a_2d_run_has_no_maps(write, error_of):
    said = error_of(
        write("", "[body.b]\nshape='box'\nmaterial='water'\nmin=[0,0]\nmax=[1,1]\n[maps]\ncell=1\n")
    )
    assert "only a 3-D run has it" in said


def test_a_clamped_body_is_no_part_of_the_flow(tmp_path):
    """Nor do maps made afterwards count it."""
    file = tmp_path / "dam.toml"
    file.write_text(COLLAPSE + DAM)
    scenario = load_scenario(file, ["time_max=0.02", "time_out=0.02", "dp=0.025"])
    run_scenario(scenario, tmp_path / "run", RunOptions(1))
    folder = RunFolder(tmp_path / "run")
    kept = {name: read_raster(folder.maps / f"{name}.asc") for name in NAMES}
    settings = MapSettings.of(scenario.maps.model_dump(exclude_none=True), scenario.dp)
    made = maps_from_snapshots(load(tmp_path / "run"), map_grid(folder, settings), settings)
    for maps in (kept, made):
        depth = maps["peak_depth"].values
        assert depth[:, 1:4].max() > 0.2, "the water"
        assert not depth[:, 6:].any(), "the dam"
        assert not maps["deposit"].values[:, 6:].any()
