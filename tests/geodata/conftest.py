"""Rasters and files that tests of maps share."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from doseki.geodata.errors import GeodataError
from doseki.geodata.raster import Raster

# Measurements and maps of others, beside the clone; never part of it.
TERRAIN = Path(__file__).resolve().parents[3] / "shared" / "data" / "terrain"


@pytest.fixture
def terrain_data() -> Path:
    """The folder of real terrain; skips where there is none."""
    if not TERRAIN.is_dir():
        pytest.skip("no shared/data/terrain beside the clone")
    return TERRAIN


@pytest.fixture
def gdal() -> str:
    """Skips where GDAL's own programs are not installed."""
    if shutil.which("gdalinfo") is None:
        pytest.skip("no gdalinfo on this machine: apt-get install gdal-bin")
    return "gdalinfo"


def plane_at(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Heights of a slope at map coordinates."""
    return 1500 + 0.3 * (x - 460_000) - 0.7 * (y - 5_200_000)


@pytest.fixture
def plane() -> Raster:
    """A slope of 30 x 20 cells of 5 m at coordinates of a real map."""
    empty = Raster(np.zeros((30, 20)), 460_000.0, 5_200_000.0, 5.0)
    return empty.with_values(plane_at(empty.x[None, :], empty.y[:, None]))


@pytest.fixture
def hills() -> Raster:
    """A rough surface in which some cells have no data."""
    random = np.random.default_rng(7)
    values = 800 + 40 * random.standard_normal((13, 17))
    values[2, 3] = values[5:8, 6:9] = values[-1, -1] = np.nan
    return Raster(values, 460_000.25, 5_200_000.5, 2.5, nodata=-9999.0)


@pytest.fixture
def refusal() -> Callable[..., str]:
    """What is said in one sentence by something that is refused."""

    def said(action: Callable[..., object], *arguments: object) -> str:
        with pytest.raises(GeodataError) as caught:
            action(*arguments)
        text = str(caught.value)
        assert "\n" not in text
        return text

    return said
