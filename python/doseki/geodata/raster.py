"""Rasters read from files and written: ESRI ASCII grids, and GeoTIFF with the extra `terrain`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..util.foreign import open_regular
from .ascii_grid import is_ascii_grid, read_ascii_grid, write_ascii_grid
from .errors import GeodataError
from .geotiff import is_tiff, read_geotiff, write_geotiff
from .grid import Raster, means_no_data
from .shapes import LARGEST

__all__ = ["Raster", "holds_raster", "read_raster", "write_raster"]

ASCII_SUFFIXES = (".asc", ".txt", ".grd")
RASTER_SUFFIXES = (".asc", ".tif", ".tiff")  # of files that hold nothing else
TIFF_SUFFIXES = (".tif", ".tiff", ".geotiff")
START = 64  # bytes that tell what a file is


def read_raster(path: Path | str, window: Sequence[float] | None = None) -> Raster:
    """A raster, by what its file holds, not by its name; or the cells that cover a window of it, m.

    Of a GeoTIFF: any compression, tiling and kind of number, scale and offset applied; one band.
    Of an ESRI ASCII grid: lines xllcorner or xllcenter, in capitals or not; its .prj beside it.

    Raises:
        GeodataError: it is damaged or of another format, has no square cells with north up, is not
            in metres, or rasterio is missing.
        WindowError: the window is empty, or reaches beyond the raster.
        UserError: it cannot be read.

    """
    path = Path(path)
    start = _start(path)
    if is_tiff(start):
        raster = read_geotiff(path, window)
    elif is_ascii_grid(start):
        raster = read_ascii_grid(path)
        raster = raster if window is None else raster.window(*window)
    else:
        raise GeodataError(
            f"{path}: neither a GeoTIFF nor an ESRI ASCII grid; convert it with "
            f"gdal_translate -of GTiff IN OUT"
        )
    far = max(map(abs, raster.extent))
    if not far < LARGEST:
        raise GeodataError(
            f"{path}: reaches to {far:g} m (cells of {raster.cell:g} m); coordinates must be below "
            f"{LARGEST:g} m"
        )
    return raster


def holds_raster(path: Path) -> bool:
    """Whether a file begins like a raster, or has the name of one; raises UserError."""
    start = _start(path)
    return is_tiff(start) or is_ascii_grid(start) or path.suffix.lower() in RASTER_SUFFIXES


def _start(path: Path) -> bytes:
    with open_regular(path) as (file, _):
        return bytes(file.read(START))


def write_raster(path: Path | str, raster: Raster, tags: Mapping[str, str] | None = None) -> None:
    """Write a raster, whole or not at all; .asc is an ESRI ASCII grid, .tif a GeoTIFF.

    Numbers are read back as they were. `tags` are metadata of a GeoTIFF; ASCII grids have none.

    Raises:
        GeodataError: the ending is none of these, rasterio is missing, or its `nodata` is also the
            value of a cell that has data.
        UserError, ResourceError: it cannot be written.

    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in ASCII_SUFFIXES + TIFF_SUFFIXES:
        raise GeodataError(f"{path}: rasters are written as .asc or .tif")
    _check_nodata(path, raster, suffix)
    if suffix in ASCII_SUFFIXES:
        write_ascii_grid(path, raster)
    else:
        write_geotiff(path, raster, dict(tags or {}))


def _check_nodata(path: Path, raster: Raster, suffix: str) -> None:
    """Raise GeodataError where a cell with data would be read back as one without."""
    nodata = raster.nodata
    if nodata is None:
        if suffix in TIFF_SUFFIXES:
            return
        nodata = -9999.0
    if np.any(means_no_data(raster.values, nodata)):
        raise GeodataError(f"{path}: a cell holds {nodata:g}, which is to mean no data")
