"""A slope of Tyrol with a release area and its reference rasters (AvaFrame's avaAlr)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.geodata.crs import same_crs
from doseki.geodata.features import read_features
from doseki.geodata.raster import read_raster
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario
from doseki.scene.kinds.release import released_volumes

DATA = Path(__file__).resolve().parents[3] / "shared/data/terrain/avaAlr/Inputs"
MAP, AREA = DATA / "avaAlr.tif", DATA / "REL/relAlr.shp"

pytest.importorskip("rasterio")
pytest.importorskip("pyogrio")
pytestmark = pytest.mark.skipif(not MAP.exists(), reason=f"no measured data: {MAP} is not there")

SCENARIO = f"""
dim = 3
dp = 1.5
time_max = 0.3
time_out = 0.3
scheme = "resolved"
gravity = [0, 0, -9.81]
speed_max = 60
[terrain]
file = "{MAP}"
material = "basalt"
wall = "voellmy"
mu = 0.2
turbulent_xi = 2000
[body.slide]
shape = "release"
material = "water"
file = "{AREA}"
[maps]
interval = 0.3
"""


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "alplehner.toml"
    file.write_text(SCENARIO)
    return file


def test_the_volume_is_that_of_the_file(path):
    """Its polygon has a thickness of 1 m; the area of the ground is taken from the map itself."""
    (area,) = read_features(AREA).polygons
    raster = read_raster(MAP)
    x, y = np.meshgrid(raster.x, raster.y)
    # Two triangles in each square of four centres.
    z = raster.values / raster.cell
    along = np.stack([z[:-1, 1:] - z[:-1, :-1], z[1:, 1:] - z[1:, :-1]])
    across = np.stack([z[1:, :-1] - z[:-1, :-1], z[1:, 1:] - z[:-1, 1:]])
    steep = np.sqrt(1 + along**2 + across**2).mean(axis=0)
    inside = area.contains(x, y)[:-1, :-1]
    exact = area.area * steep[inside].mean()
    ((asked, volume),) = released_volumes(load_scenario(path)).values()
    assert asked == pytest.approx(exact, rel=0.01)
    assert volume == pytest.approx(exact, rel=0.01)
    assert exact > 1.1 * area.area


@pytest.mark.minutes
def test_maps_have_the_grid_of_the_map_and_mass_is_kept(path, tmp_path):
    scenario = load_scenario(path, ["dp=4", "body.slide.thickness=6"])
    folder = tmp_path / "run"
    summary = run_scenario(scenario, folder)
    given = read_raster(MAP)
    for name in ("peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit"):
        made = read_raster(folder / f"maps/{name}.tif")
        assert made.same_grid(given), name
        assert same_crs(made.crs, given.crs), name
        assert "31287" in str(made.crs) or same_crs(made.crs, "EPSG:31287")
    depth = read_raster(folder / "maps/peak_depth.tif").values
    assert 3 < np.nanmax(depth) < 25
    assert abs(summary["ledger_residual"]) < 1e-10 * summary["mass_initial"]
    position = load(folder)[-1]["position"]
    west, _, _, north = given.extent
    assert (position[:, 0] > west).all()
    assert (position[:, 1] < north).all()
    asked, volume = summary["released"]["slide"]
    assert volume == pytest.approx(asked, rel=0.01)
