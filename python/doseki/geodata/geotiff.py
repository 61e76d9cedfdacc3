"""GeoTIFF, by rasterio (GDAL)."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..util.files import write_whole
from ..util.foreign import readable
from ..util.memory import available_bytes
from .ascii_grid import SQUARE, not_square
from .crs import check_map_coordinates, heights_not_metres
from .errors import GeodataError, needed
from .grid import Frame, Raster, means_no_data

MAGIC = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
WHAT = "a GeoTIFF"
METRES = ("", "m", "metre", "meter", "metres", "meters")
BYTES = 32  # of memory for a cell while it is read


def is_tiff(start: bytes) -> bool:
    """Whether a file that begins like this is a TIFF."""
    return start[:4] in MAGIC


def read_geotiff(path: Path, window: Sequence[float] | None = None) -> Raster:
    """The raster of a file with one band, or the whole cells that cover a window of it, m.

    Nothing else is read than these.

    Raises:
        GeodataError: it is damaged, not in metres, not of square cells, or rasterio is missing.
        WindowError: the window is empty, or reaches beyond the raster.
        UserError: it cannot be read.

    """
    rasterio = needed("rasterio", path, WHAT)
    with warnings.catch_warnings(), readable(path, kind=WHAT):
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        # Only this driver: others would follow what a file says to other files.
        # Within an Env what GDAL has to say does not go to the terminal.
        with rasterio.Env(), rasterio.open(path, driver="GTiff") as dataset:
            _check(path, dataset)
            return _raster(path, dataset, window)


def _check(path: Path, dataset: Any) -> None:
    """Raise GeodataError for what a flow cannot be computed on."""
    if dataset.count != 1:
        raise GeodataError(
            f"{path}: {dataset.count} bands where one is needed; take one with "
            f"gdal_translate -b 1 IN OUT"
        )
    at = dataset.transform
    if at.is_identity:
        raise GeodataError(f"{path}: says nowhere where on the map it lies")
    if not all(map(math.isfinite, at)):
        raise GeodataError(f"{path}: its place on the map is not finite")
    if at.b or at.d or at.a < 0:
        raise GeodataError(f"{path}: is rotated; turn it north up with gdalwarp IN OUT")
    if abs(abs(at.e) - at.a) > SQUARE * at.a or at.a == 0:
        raise GeodataError(not_square(path, at.a, abs(at.e)))
    if dataset.crs:
        check_map_coordinates(path, dataset.crs.to_wkt())
    unit = dataset.units[0] or ""
    if unit.lower() not in METRES:
        raise GeodataError(heights_not_metres(path, unit))
    if np.dtype(dataset.dtypes[0]).kind not in "iuf":
        raise GeodataError(f"{path}: holds {dataset.dtypes[0]}, and numbers are needed")


def _raster(path: Path, dataset: Any, window: Sequence[float] | None) -> Raster:
    at = dataset.transform
    upwards = at.e > 0  # its rows run from south to north
    south = at.f + min(at.e, 0.0) * dataset.height
    frame, left, below = Frame(at.c, south, at.a, dataset.shape), 0, 0
    if window is not None:
        frame, left, below = frame.window(window)
    above = below if upwards else dataset.height - below - frame.shape[0]
    raw, unknown = _read(path, dataset, (above, left), frame.shape)
    values = raw.astype(np.float64) * dataset.scales[0] + dataset.offsets[0]
    values[unknown] = np.nan
    endless = np.argwhere(np.isinf(values))
    if len(endless):
        row, column = endless[0]
        more = f", and {len(endless) - 1} more cells do" if len(endless) > 1 else ""
        raise GeodataError(
            f"{path}: row {row + above + 1}, column {column + left + 1} holds "
            f"{values[row, column]}{more}, which is no height: mend it, or let the file say that "
            "it means no data"
        )
    return Raster(
        np.ascontiguousarray(values[::-1] if upwards else values),
        frame.west,
        frame.south,
        frame.cell,
        dataset.crs.to_wkt() if dataset.crs else None,
        "GTiff",
        dataset.nodata,
    )


def _read(
    path: Path, dataset: Any, start: tuple[int, int], shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of so many rows and columns of the file, and where they mean no data."""
    rasterio = needed("rasterio", path, WHAT)
    rows, columns = shape
    if rows * columns * BYTES > available_bytes():
        raise GeodataError(f"{path}: {columns} x {rows} cells are more than this machine can hold")
    part = rasterio.windows.Window(start[1], start[0], columns, rows)
    try:
        raw = dataset.read(1, window=part)
        return raw, _unknown(raw, dataset, part)
    except rasterio.errors.RasterioIOError:
        raise GeodataError(
            f"{path}: begins as a GeoTIFF but cannot be read to its end: it is damaged, or was cut "
            "off as it was copied or downloaded; bring a whole one"
        ) from None


def _unknown(raw: np.ndarray, dataset: Any, part: Any) -> np.ndarray:
    """Where there is no data: by the mask of the file, or by its number."""
    unknown = dataset.read_masks(1, window=part) == 0
    if raw.dtype.kind == "f":
        unknown |= np.isnan(raw)
    nodata = dataset.nodata
    if nodata is not None and math.isfinite(nodata) and raw.dtype.kind == "f":
        unknown |= means_no_data(raw, nodata)
    return np.asarray(unknown)


def write_geotiff(path: Path, raster: Raster, tags: dict[str, str]) -> None:
    """Write a raster as float64, compressed without loss; `tags` are names and texts."""
    rasterio = needed("rasterio", path, WHAT)
    nodata = math.nan if raster.nodata is None else raster.nodata
    values = np.where(np.isnan(raster.values), nodata, raster.values)
    about: dict[str, Any] = {
        "driver": "GTiff", "dtype": "float64", "count": 1, "compress": "deflate", "predictor": 3,
        "height": raster.shape[0], "width": raster.shape[1], "nodata": nodata,
        "transform": rasterio.Affine(raster.cell, 0, raster.west, 0, -raster.cell, raster.north),
    }  # fmt: skip

    def write(temporary: Path) -> None:
        if raster.crs is not None:
            about["crs"] = rasterio.crs.CRS.from_user_input(raster.crs)
        with rasterio.open(temporary, "w", **about) as dataset:
            dataset.write(values, 1)
            dataset.update_tags(**tags)

    errors = rasterio.errors
    with warnings.catch_warnings(), rasterio.Env():
        warnings.simplefilter("ignore", errors.NotGeoreferencedWarning)
        try:
            write_whole(path, write)
        except (errors.RasterioError, errors.CRSError) as error:
            raise GeodataError(f"{path}: cannot be written: {error}") from None
