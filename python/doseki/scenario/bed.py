"""The bed of [terrain]: heights on a grid, read from a map or from a profile."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.ndimage import distance_transform_edt

from ..errors import UserError
from ..geodata.crs import MapScale, map_scale
from ..geodata.errors import GeodataError, WindowError
from ..geodata.ground import Profile
from ..geodata.raster import Raster, read_raster
from .islands import MAX_CELLS, Islands, islands_of
from .particle_files.columns_csv import numbers_in, read_csv_columns
from .tables.terrain.terrain import Terrain
from .terraces import Terraces, terraces_of
from .values.toml_source import Where
from .values.units import LENGTH

PROFILE_EXAMPLE = "x [m],z [m]"
TILE_COLUMNS = {2: 16, 3: 8}  # spacings along a side of a tile (core/boundaries/terrain.hpp)
NO_HEIGHTS = (-9999.0, -32768.0, -32767.0, -99999.0, float(np.finfo(np.float32).min))
HIGHEST = 1e5  # m from 0, of a height
MAX_NODES = 50_000_000  # of a profile or a section; 0.4 GB


@dataclass(frozen=True, eq=False)
class Bed:
    """Heights of the ground at the nodes of a square grid, up to where the map goes.

    Attributes:
        origin: (dim - 1,) place of the first node, m, in the coordinates of the run.
        cell: distance between nodes, m.
        heights: (nodes,) in 2-D, (rows from south to north, columns from west to east) in 3-D, m;
            nodes that the map knows nothing of have the height of the nearest one that it knows.
        unknown: the same shape, 1 at such nodes.
        raster: 3-D: the map as it is used, after window, resampling and smoothing; in 2-D None.
        scale: how long a metre is on the map, where that is known.
        as_read: the map before it is resampled and smoothed, in 3-D and of a section, unless it is
            very large.

    """

    origin: np.ndarray
    cell: float
    heights: np.ndarray
    unknown: np.ndarray
    raster: Raster | None = None
    scale: MapScale | None = None
    as_read: Raster | None = None

    @cached_property
    def islands(self) -> Islands | None:
        """Cells of the map as it was read that look like holes written as a number."""
        return None if self.as_read is None else islands_of(self.as_read)

    @cached_property
    def terraces(self) -> Terraces | None:
        """The steps in which the heights of the map as it was read come."""
        return None if self.as_read is None else terraces_of(self.as_read)

    @cached_property
    def evened(self) -> Bed:
        """The bed without such steps, above which depths are measured; itself where it has none."""
        if self.terraces is None:
            return self
        grid = Raster(np.atleast_2d(self.heights), 0.0, 0.0, self.cell)
        length = min(self.terraces.length, self.cell * max(self.heights.shape))
        heights = grid.smoothed(length).values.reshape(self.heights.shape)
        return Bed(self.origin, self.cell, heights, self.unknown)

    @cached_property
    def table(self) -> dict[str, object]:
        """As the core reads it."""
        return {
            "origin": self.origin.tolist(),
            "cell": self.cell,
            "heights": np.ascontiguousarray(self.heights, np.float64),
            "unknown": np.ascontiguousarray(self.unknown, np.uint8),
        }

    @property
    def ground(self) -> Raster | Profile:
        """As the folder of a run keeps it."""
        if self.raster is not None:
            return self.raster
        x = self.origin[0] + self.cell * np.arange(len(self.heights))
        return Profile(x, self.heights)

    @property
    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper end (dim - 1,) along the horizontal axes, m."""
        nodes = np.array(self.heights.shape[::-1])
        return self.origin - 0.5 * self.cell, self.origin + (nodes - 0.5) * self.cell

    @cached_property
    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner (dim,) of the box around the ground, m."""
        low, high = self.extent
        return np.append(low, self.heights.min()), np.append(high, self.heights.max())

    def without_heights(self) -> Bed:
        """The same place without memory for heights, which are NaN; `corners` are kept."""
        shape = self.heights.shape
        nothing = np.broadcast_to(np.nan, shape), np.broadcast_to(np.uint8(0), shape)
        light = Bed(self.origin, self.cell, *nothing)
        light.__dict__["corners"] = self.corners
        return light

    @property
    def unknown_share(self) -> float:
        """The share of the grid of which the map knows nothing."""
        return float(np.mean(self.unknown))


def read_bed(path: Path, terrain: Terrain, dim: int, dp: float, where: Where) -> Bed:
    """The bed that [terrain] describes; raises UserError, which names the key."""
    try:
        if dim == 2 and path.suffix.lower() == ".csv":
            return _bed_of_profile(path, terrain, dp, where)
        as_read = _with_heights(path, _read(path, terrain, where), terrain)
        raster = _remade(as_read, terrain, where)
        kept = as_read if as_read.values.size <= MAX_CELLS else None
    except GeodataError as error:
        raise where.error(("terrain",), f"terrain: {error}") from None
    if dim == 3:
        return replace(_bed_of_raster(path, raster, where), as_read=kept)
    if terrain.section is None:
        raise where.error(
            ("terrain",),
            "terrain.section is missing: a 2-D run cuts a grid along a line, [[x, y], [x, y]]; "
            "or give a CSV file with columns x and z",
        )
    return replace(_bed_of_section(path, raster, terrain, dp, where), as_read=kept)


def _read(path: Path, terrain: Terrain, where: Where) -> Raster:
    """What is used of the map; one that cannot be opened or is damaged is named with its key."""
    try:
        return read_raster(path, terrain.window)
    except WindowError as error:
        raise where.error(("terrain", "window"), f"terrain.window: {error}") from None
    except GeodataError:
        raise
    except UserError as error:
        raise _error(where, str(error)) from None


def _with_heights(path: Path, raster: Raster, terrain: Terrain) -> Raster:
    """The raster, unless it has numbers that are no heights, as those that mean no data."""
    for number in NO_HEIGHTS:
        cells = int((raster.values == number).sum())
        if cells:
            raise GeodataError(
                f"{path}: {cells} cells hold {number:g}, which is no height: let the file say that "
                f"it means no data (gdal_edit -a_nodata {number:g} IN; .asc: a line NODATA_value)"
            )
    if cell := raster.beyond(HIGHEST):
        part = "" if terrain.window is None else ", in the window"
        raise GeodataError(
            f"{path}{part}: {cell}, and heights are within {HIGHEST:g} m of 0: mend it, or let the "
            "file say that it means no data (gdal_edit -a_nodata; .asc: a line NODATA_value)"
        )
    return raster


@contextmanager
def _asked_by(key: str, where: Where) -> Iterator[None]:
    """Name the key of [terrain] that asks for what a map cannot give."""
    try:
        yield
    except GeodataError as error:
        raise where.error(("terrain", key), f"terrain.{key}: {error}") from None


def _remade(raster: Raster, terrain: Terrain, where: Where) -> Raster:
    """With cells of another size, and smoothed."""
    if terrain.resample is not None:
        with _asked_by("resample", where):
            raster = raster.resampled(terrain.resample)
    if terrain.smoothing is not None:
        with _asked_by("smoothing", where):
            raster = raster.smoothed(terrain.smoothing)
    return raster


def _bed_of_raster(path: Path, raster: Raster, where: Where) -> Bed:
    if min(raster.shape) < 2:
        raise _error(where, f"{path}: {raster.shape} cells; a terrain needs 2 along each axis")
    heights, unknown = _filled(path, raster.values[::-1], where)
    origin = np.array([raster.west, raster.south]) + 0.5 * raster.cell
    west, south, east, north = raster.extent
    scale = map_scale(raster.crs, 0.5 * (west + east), 0.5 * (south + north))
    return Bed(origin, raster.cell, heights, unknown, raster, scale)


def _error(where: Where, text: str) -> UserError:
    """What is wrong with the file, with its key."""
    return where.error(("terrain", "file"), f"terrain.file: {text}")


def _bed_of_section(path: Path, raster: Raster, terrain: Terrain, dp: float, where: Where) -> Bed:
    """Along a line on the map; x is the distance from its first end."""
    assert terrain.section is not None
    start, end = (np.array(place) for place in terrain.section)
    length = float(np.linalg.norm(end - start))
    cell = terrain.resample or dp
    x = _nodes(0.0, length, cell, where)
    places = start + x[:, None] * (end - start) / length
    heights = raster.sampled(places[:, 0], places[:, 1])
    if np.isnan(heights[[0, -1]]).any():
        raise where.error(
            ("terrain", "section"), "terrain.section: an end lies where the map has no data"
        )
    filled, unknown = _filled(path, heights, where)
    return Bed(x[:1], cell, filled, unknown, scale=map_scale(raster.crs, *(start + end) / 2))


def _bed_of_profile(path: Path, terrain: Terrain, dp: float, where: Where) -> Bed:
    """Straight lines through the points (x, z) of a file."""
    for key in ("section", "window"):
        if getattr(terrain, key) is not None:
            raise where.error(("terrain", key), f"terrain.{key}: is for grids, not for a profile")
    try:
        columns = read_csv_columns(path, PROFILE_EXAMPLE)
    except UserError as error:
        raise _error(where, str(error)) from None
    try:
        x, z = (np.array(numbers_in(columns, name, LENGTH, PROFILE_EXAMPLE)) for name in "xz")
    except ValueError as error:
        raise _error(where, f"{path}: {error}") from None
    if len(x) < 2 or not (np.diff(x) > 0).all():
        raise _error(where, f"{path}: x must go up from row to row, in two rows or more")
    if not (np.isfinite(x).all() and np.isfinite(z).all()):
        raise _error(where, f"{path}: holds numbers that are not finite")
    if (beyond := np.abs(z) > HIGHEST).any():
        row = int(np.argmax(beyond))
        raise _error(
            where,
            f"{path}: row {row + 1} has z = {z[row]:g} m, and heights are within {HIGHEST:g} m of "
            "0",
        )
    cell = terrain.resample or dp
    nodes = _nodes(float(x[0]), float(x[-1]), cell, where)
    heights = np.interp(nodes, x, z)
    if terrain.smoothing is not None:
        line = Raster(heights[None, :], nodes[0], 0.0, cell).smoothed(terrain.smoothing)
        heights = line.values[0]
    return Bed(nodes[:1], cell, heights, np.zeros(len(nodes), np.uint8))


def _nodes(low: float, high: float, cell: float, where: Where) -> np.ndarray:
    count = (high - low) / cell
    if not 1 <= count <= MAX_NODES:
        raise where.error(
            ("terrain",),
            f"terrain: {count:.3g} cells of {cell:g} m along x; allowed: 1 to {MAX_NODES:.3g} "
            "(set terrain.resample)",
        )
    return low + cell * np.arange(int(count + 1e-9) + 1)


def _filled(path: Path, heights: np.ndarray, where: Where) -> tuple[np.ndarray, np.ndarray]:
    """Heights everywhere, and where they are not known."""
    unknown = np.isnan(heights)
    if unknown.all():
        raise _error(where, f"{path}: no cell of the part that is used has data")
    if unknown.any():
        nearest = distance_transform_edt(unknown, return_distances=False, return_indices=True)
        heights = heights[tuple(nearest)]
    return np.array(heights), unknown.astype(np.uint8)
