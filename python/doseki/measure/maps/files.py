"""Maps in the folder of a run: rasters in the terrain's format, with its system of coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...geodata.grid import NODATA, Raster
from ...geodata.raster import read_raster, write_raster
from ...record.folder import RunFolder
from ...util.files import clear_errors
from .contours import write_contours
from .grid import MapSettings
from .peaks import Peaks, deposit
from .quantities import (
    ARRIVAL_TIME,
    DEPOSIT,
    PEAK_DEPTH,
    QUANTITIES,
    REMEMBERED,
    MapQuantity,
)

BEYOND = 1e30  # which no result reaches
CONTOURS = f"{PEAK_DEPTH.name}_contours.geojson"


def rasters_of(
    peaks: Peaks, state: Mapping[str, np.ndarray], settings: MapSettings
) -> dict[str, Raster]:
    """Every map: peaks so far, and the deposit of particles as they are now."""
    grid = peaks.grid
    values = {quantity.name: peaks.map_of(quantity.name) for quantity in REMEMBERED}
    values[DEPOSIT.name] = deposit(grid, state, settings.speed_deposit, settings.dry_below)
    nodata = _nodata(grid)
    return {name: replace(_masked(grid, each), nodata=nodata) for name, each in values.items()}


def _nodata(grid: Raster) -> float:
    """The number of the terrain for no data, unless it might be a result, which are not below 0."""
    own = grid.nodata
    if own is None or not (own < 0 or own > BEYOND or grid.can_hold_nan(own)):
        return NODATA
    return own


def _masked(grid: Raster, values: np.ndarray) -> Raster:
    """No data where the terrain has none, unless something flowed there."""
    beside = np.isnan(grid.values) & ~np.isnan(grid.values).all() & (values == 0)
    return grid.with_values(np.where(beside, np.nan, values))


def write_maps(
    folder: RunFolder, rasters: Mapping[str, Raster], settings: MapSettings, time: float
) -> list[Path]:
    """Write DIR/maps/NAME.tif or .asc, and contours of the largest depth; returns the rasters.

    `time`, s, is that of the deposit.
    """
    with clear_errors(folder.maps):
        folder.maps.mkdir(exist_ok=True)
    files = []
    for quantity in QUANTITIES:
        raster = rasters[quantity.name]
        path = folder.maps / f"{quantity.name}{raster.suffix}"
        write_raster(path, raster, _tags(quantity, time))
        files.append(path)
    depth = rasters[PEAK_DEPTH.name]
    write_contours(folder.maps / CONTOURS, depth, PEAK_DEPTH, settings.dry_below)
    return files


def _tags(quantity: MapQuantity, time: float) -> dict[str, str]:
    tags = {"quantity": quantity.name, "unit": quantity.unit, "description": quantity.label}
    tags["simulated_time"] = f"{time:.9g} s"
    return tags | ({"avaframe": quantity.avaframe} if quantity.avaframe else {})


def read_maps(folder: RunFolder) -> dict[str, Raster]:
    """The maps in DIR/maps by name; none where not all of them are there."""
    found = {}
    for quantity in QUANTITIES:
        paths = [folder.maps / f"{quantity.name}{suffix}" for suffix in (".tif", ".asc")]
        here = [path for path in paths if path.is_file()]
        if not here:
            return {}
        found[quantity.name] = read_raster(here[0])
    return found


def reached(maps: Mapping[str, Raster]) -> np.ndarray:
    """Mask (rows, cols) of the cells where something has flowed."""
    return ~np.isnan(maps[ARRIVAL_TIME.name].values)
