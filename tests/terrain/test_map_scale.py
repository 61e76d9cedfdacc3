"""Maps on which lengths are not those on the ground are warned about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doseki.geodata.crs import map_scale
from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.scene.checks.terrain import Stretched

from .scenes import text

pytest.importorskip("rasterio", reason="rasterio: pip install 'doseki[terrain]'")

PLACE = {3857: (1_000_000.0, 5_942_074.0), 32632: (497_000.0, 5_205_000.0)}  # at 47 degrees N
SLIDE = """
[body.slide]
shape = "release"
material = "water"
{keys}
thickness = 0.3
"""


@pytest.mark.parametrize(
    ("crs", "place", "factor"),
    [
        ("EPSG:3857", (0.0, 0.0), 1.0067),  # of a sphere: along a meridian of the ellipsoid
        ("EPSG:3857", PLACE[3857], 1.4682),  # close to 1 / cos(47 degrees)
        ("EPSG:32632", PLACE[32632], 0.9996),  # that of UTM in the middle of a zone
        ("EPSG:2056", (2_600_000.0, 1_200_000.0), 1.0),  # at its origin
        ("EPSG:25832+7837", PLACE[32632], 0.9996),  # with heights
    ],
)
def test_the_scale_of_maps(crs, place, factor):
    assert map_scale(crs, *place).factor == pytest.approx(factor, abs=1e-4)


def test_the_zone_of_utm_is_that_of_the_place():
    assert map_scale("EPSG:3857", *PLACE[3857]).utm == 32632
    assert map_scale("EPSG:3857", 15_500_000.0, -5_000_000.0).utm == 32754
    assert map_scale("EPSG:3857", -20_037_508.0, 1.0).utm == 32601


@pytest.mark.parametrize("crs", [None, 'LOCAL_CS["x",UNIT["metre",1]]', "EPSG:4326", "no such"])
def test_other_systems_have_no_scale(crs):
    assert map_scale(crs, 0.0, 0.0) is None


def test_a_place_that_is_on_no_map_has_no_scale():
    assert map_scale("EPSG:32632", 1e9, 1e9) is None


@pytest.fixture
def doubts(tmp_path):
    """What is said of the scale of a slope on a map of a system: a function of its number."""

    def find(code, dim):
        west, south = PLACE[code]
        bed = Raster(np.zeros((40, 60)), west, south, 0.1, f"EPSG:{code}")
        bed = bed.with_values(2 - 0.2 * (bed.x - west) + 0.0 * bed.y[:, None])
        write_raster(tmp_path / "dem.tif", replace(bed, driver="GTiff"))
        corners = [[west + a, south + b] for a, b in ((1, 1), (2, 1), (2, 2), (1, 2))]
        keys, more = f"polygon = {corners}", ""
        if dim == 2:
            keys = "between = [1, 2]"
            ends = [[west + 0.2, south + 2], [west + 5.8, south + 2]]
            more = f"[terrain]\nsection = {ends}"
        path = tmp_path / "case.toml"
        scenario = text(dim, dp=0.1, more=SLIDE.format(keys=keys))
        for name in ("terrain.asc", "terrain.csv"):
            scenario = scenario.replace(name, "dem.tif")
        path.write_text(scenario.replace("[terrain]", more) if more else scenario)
        found = build_scene(load_scenario(path)).warnings
        return [str(each) for each in found if isinstance(each, Stretched)]

    return find


@pytest.mark.parametrize("dim", [2, 3])
def test_web_mercator_is_warned_about(doubts, dim):
    (said,) = doubts(3857, dim)
    assert said.startswith("terrain.file: lengths on this map are 1.47 times those on the ground")
    assert "at 47 degrees N" in said
    assert "gdalwarp -t_srs EPSG:32632" in said


@pytest.mark.parametrize("dim", [2, 3])
def test_a_system_of_metres_is_not(doubts, dim):
    assert doubts(32632, dim) == []
