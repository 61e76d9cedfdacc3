"""Whatever a raster or a file of features holds: numbers that can be used, or one sentence."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from doseki.errors import UserError
from doseki.geodata.features import read_features
from doseki.geodata.grid import Raster
from doseki.geodata.raster import read_raster, write_raster

from .examples import examples
from .generators import damaged

GRID = b"ncols 3\nnrows 2\nxllcorner 460000\nyllcorner 5200000\ncellsize 2.5\nNODATA_value -9\n"
VALUES = b"1 2.5 3\n-9 5e2 6\n"
FEATURES = {
    "type": "FeatureCollection",
    "features": [
        {
            "type": "Feature",
            "properties": {"thickness": 1.5, "name": None},
            "geometry": {"type": "MultiPolygon", "coordinates": [[[[0, 0], [1, 0], [1, 1]]]]},
        },
        {
            "type": "Feature",
            "properties": {},
            "geometry": {"type": "LineString", "coordinates": [[0, 0, 3], [1, 0, 4]]},
        },
    ],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("maps")


@pytest.fixture(scope="module")
def geotiff(folder):
    pytest.importorskip("rasterio", reason="rasterio: pip install 'doseki[terrain]'")
    values = np.random.default_rng(1).random((9, 11))
    write_raster(folder / "whole.tif", Raster(values, 460_000.0, 5.2e6, 2.0, "EPSG:32633", "GTiff"))
    return (folder / "whole.tif").read_bytes()


def usable(raster):
    """Whether it is a grid on which one can go on."""
    assert not np.isinf(raster.values).any()
    assert np.isfinite(raster.extent).all()
    assert raster.cell > 0
    return raster.smoothed(raster.cell).shape == raster.shape


def read_or_said(read, path):
    """What is read, or None after one sentence."""
    said = []
    found = None
    try:
        found = read(path)
    except UserError as error:
        said.append(str(error))
    assert not any("\n" in text or str(path) not in text for text in said)
    return found


@examples(60, 10_000)
@given(data=damaged(GRID + VALUES))
@pytest.mark.filterwarnings("error")
def test_any_ascii_grid(folder, data):
    (folder / "a.asc").write_bytes(data)
    raster = read_or_said(read_raster, folder / "a.asc")
    assert raster is None or usable(raster)


@examples(60, 10_000)
@given(data=st.data())
def test_any_geotiff(folder, geotiff, data):
    (folder / "a.tif").write_bytes(data.draw(damaged(geotiff)))
    raster = read_or_said(read_raster, folder / "a.tif")
    assert raster is None or usable(raster)


@examples(60, 10_000)
@given(data=damaged(json.dumps(FEATURES).encode()))
@pytest.mark.filterwarnings("error")
def test_any_geojson(folder, data):
    (folder / "a.geojson").write_bytes(data)
    found = read_or_said(read_features, folder / "a.geojson")
    if found is not None:
        for polygon in found.polygons:
            assert polygon.contains(np.zeros(3), np.arange(3)).shape == (3,)
            assert np.isfinite(polygon.outer).all()
        assert all(np.isfinite(line.vertices).all() for line in found.lines)
