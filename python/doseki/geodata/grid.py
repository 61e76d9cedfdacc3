"""A raster: numbers on the square cells of a map, and what is done with them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from .errors import GeodataError, WindowError
from .interpolation import area_mean, bilinear, locally_linear

TOLERANCE = 1e-6  # of a cell, by which edges of grids may differ
MAX_CELLS = 400_000_000  # of a grid that is made; 3.2 GB
NODATA = -9999.0  # the usual number for no data
OTHERS = (NODATA, -32768.0, -99999.0, -3.4028234663852886e38)  # where that is a value
SUFFIX = {"GTiff": ".tif", "AAIGrid": ".asc"}


def means_no_data(values: np.ndarray, nodata: float) -> np.ndarray:
    """Where values are the number for no data.

    Also where both are the same in single precision: of such rasters files often hold one of the
    two with fewer digits.
    """
    with np.errstate(over="ignore"):
        single = np.float32(nodata)
        alike = values.astype(np.float32) == single
    return np.asarray((values == nodata) | (alike if np.isfinite(single) else False))


@dataclass(frozen=True)
class Frame:
    """Where the square cells of a raster lie: outer corner and side, m, rows and columns."""

    west: float
    south: float
    cell: float
    shape: tuple[int, int]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges: west, south, east, north, m."""
        rows, cols = self.shape
        return self.west, self.south, self.west + self.cell * cols, self.south + self.cell * rows

    def window(self, window: Sequence[float], named: str = "window") -> tuple[Frame, int, int]:
        """The whole cells that cover [west, south, east, north], m.

        With them comes how many columns are west of them, and how many rows south.

        Raises:
            WindowError: it is empty, or reaches beyond the raster.

        """
        west, south, east, north = window
        asked = f"{named} [{west:.10g}, {south:.10g}, {east:.10g}, {north:.10g}]"
        if not (west < east and south < north):
            raise WindowError(f"{asked} must be west < east and south < north")
        first, last = self._cells(west - self.west, east - self.west)
        low, high = self._cells(south - self.south, north - self.south)
        rows, cols = self.shape
        if first < 0 or low < 0 or last > cols or high > rows:
            edges = ", ".join(f"{edge:.10g}" for edge in self.extent)
            raise WindowError(f"{asked} reaches beyond the raster, which has [{edges}]")
        corner = self.west + first * self.cell, self.south + low * self.cell
        return Frame(*corner, self.cell, (high - low, last - first)), first, low

    def _cells(self, start: float, end: float) -> tuple[int, int]:
        """The first cell, and the one after the last, that cover a stretch from an edge, m."""
        first = math.floor(start / self.cell + TOLERANCE)
        return first, max(math.ceil(end / self.cell - TOLERANCE), first + 1)


@dataclass(frozen=True, eq=False)
class Raster:
    """Numbers on square cells, north up.

    Attributes:
        values: (rows, cols) float64; row 0 is the northernmost, NaN is "no data".
        west, south: outer corner of the grid, m, in map coordinates.
        cell: side of a cell, m.
        crs: the coordinate reference system as WKT, or None where it is not known.
        driver: GDAL's name of the format in which it came and is written.
        nodata: the number that files hold where there is no data; None lets the writer choose.

    Raises GeodataError where these do not make a grid.

    """

    values: np.ndarray
    west: float
    south: float
    cell: float
    crs: str | None = None
    driver: Literal["GTiff", "AAIGrid"] = "AAIGrid"
    nodata: float | None = None

    def __post_init__(self) -> None:
        values = np.asarray(self.values, dtype=np.float64)
        if values.ndim != 2 or values.size == 0:
            raise GeodataError(f"a raster has rows and columns, not the shape {values.shape}")
        if not (math.isfinite(self.cell) and self.cell > 0):
            raise GeodataError(f"a raster's cell must be a length above 0, not {self.cell:g}")
        if not (math.isfinite(self.west) and math.isfinite(self.south)):
            raise GeodataError(f"a raster's corner must be finite: {self.west:g}, {self.south:g}")
        if np.isinf(values).any():
            raise GeodataError("a raster holds infinite values")
        object.__setattr__(self, "values", values)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, cols = self.values.shape
        return rows, cols

    @property
    def east(self) -> float:
        """Outer edge, m."""
        return self.west + self.cell * self.shape[1]

    @property
    def north(self) -> float:
        """Outer edge, m."""
        return self.south + self.cell * self.shape[0]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges: west, south, east, north, m."""
        return self.west, self.south, self.east, self.north

    @property
    def x(self) -> np.ndarray:
        """Centres of the columns from west to east (cols,), m."""
        return self.west + self.cell * (np.arange(self.shape[1]) + 0.5)

    @property
    def y(self) -> np.ndarray:
        """Centres of the rows from north to south, as `values` has them (rows,), m."""
        return self.south + self.cell * (np.arange(self.shape[0])[::-1] + 0.5)

    @property
    def suffix(self) -> str:
        """The ending of a file of its format: .tif or .asc."""
        return SUFFIX[self.driver]

    def can_hold_nan(self, nodata: float) -> bool:
        """Whether a number for no data is NaN and files of its format have that."""
        return math.isnan(nodata) and self.driver == "GTiff"

    def with_free_nodata(self) -> Raster:
        """The same with its number for no data, or another one where that is one of its values."""
        own = () if self.nodata is None else (self.nodata,)
        for number in (*own, *OTHERS):
            if math.isnan(number) and not self.can_hold_nan(number):
                continue
            if not means_no_data(self.values, number).any():
                return replace(self, nodata=number)
        return replace(self, nodata=None)

    def with_values(self, values: np.ndarray) -> Raster:
        """The same grid with other values (rows, cols)."""
        if np.shape(values) != self.shape:
            raise GeodataError(f"{np.shape(values)} values for a raster of {self.shape}")
        return replace(self, values=values)

    def beyond(self, most: float) -> str | None:
        """The first number farther than `most` from 0, and where; None where none is."""
        found = np.argwhere(np.abs(self.values) > most)
        if not len(found):
            return None
        row, column = (int(k) for k in found[0])
        return f"row {row + 1}, column {column + 1} holds {self.values[row, column]:g}"

    def same_grid(self, other: Raster) -> bool:
        """Whether cells lie on those of another raster, to a millionth of a cell."""
        near = TOLERANCE * self.cell
        return self.shape == other.shape and all(
            abs(mine - its) <= near for mine, its in zip(self.extent, other.extent, strict=True)
        )

    def window(
        self, west: float, south: float, east: float, north: float, *, named: str = "window"
    ) -> Raster:
        """The whole cells that cover a rectangle of the map, m.

        Raises:
            WindowError: it is empty, or reaches beyond the raster.

        """
        frame = Frame(self.west, self.south, self.cell, self.shape)
        part, first, low = frame.window((west, south, east, north), named)
        (rows, cols), end = part.shape, self.shape[0] - low
        values = self.values[end - rows : end, first : first + cols].copy()
        return replace(self, values=values, west=part.west, south=part.south)

    def for_maps(
        self, cell: float | None, extent: Sequence[float] | None, named: str = "maps.cell"
    ) -> Raster:
        """The cells that maps of a flow on this ground have: a multiple of its own, in a window.

        `named` is what the user calls the size of a cell.

        Raises:
            GeodataError: they do not fit the raster.

        """
        times = round((cell or self.cell) / self.cell)
        if cell is not None and (times < 1 or abs(cell - times * self.cell) > TOLERANCE * cell):
            raise GeodataError(
                f"{named} = {cell:g} m is no whole multiple of the terrain's {self.cell:g} m"
            )
        raster = self.resampled(cell) if cell is not None and times > 1 else self
        return raster if extent is None else raster.window(*extent, named="extent")

    def resampled(self, cell: float) -> Raster:
        """The raster on cells of another size, from the same south-western corner.

        Finer cells are bilinear between centres, and go on linearly beyond the outermost ones and
        towards cells without data; they have data where the cell in which their centre lies has.
        Coarser ones are the mean over their area of what has data, where at least half of it has.
        Only whole cells: a strip narrower than one is left out in the north and the east.
        """
        if not (math.isfinite(cell) and cell > 0):
            raise GeodataError(f"a raster's cell must be a length above 0, not {cell:g}")
        ratio = cell / self.cell
        rows, cols = (math.floor(min(n / ratio + TOLERANCE, 1e18)) for n in self.shape)
        if min(rows, cols) < 1:
            raise GeodataError(f"cells of {cell:g} m are larger than the raster")
        if rows * cols > MAX_CELLS:
            raise GeodataError(
                f"cells of {cell:g} m make {rows * cols:.3g} of them; at most {MAX_CELLS:.3g}"
            )
        if ratio > 1 + TOLERANCE:
            upward = area_mean(self.values[::-1], (rows, cols), ratio)
        else:
            centres = [(np.arange(n) + 0.5) * ratio - 0.5 for n in (rows, cols)]
            upward = bilinear(self.values[::-1], centres[0][:, None], centres[1][None, :])
        return replace(self, values=upward[::-1], cell=cell)

    def smoothed(self, length: float) -> Raster:
        """The raster smoothed by a Gaussian of standard deviation `length`, m.

        Each cell gets the value of the plane that fits its surroundings with Gaussian weights
        (Cleveland 1979, locally weighted regression). Away from edges that is the normalised
        Gaussian mean; at edges and beside cells without data a plane stays the plane that it was.
        Cells without data stay without, and add nothing to others.
        """
        if not (math.isfinite(length) and length >= 0):
            raise GeodataError(f"smoothing must be a length of 0 or more, not {length:g}")
        if length > self.cell * max(self.shape):
            raise GeodataError(f"smoothing over {length:g} m is longer than the raster")
        if length == 0:
            return self
        return self.with_values(locally_linear(self.values, length / self.cell))

    def cells_at(
        self, x: np.ndarray | float, y: np.ndarray | float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Row and column of the cell in which each point (n,) of the map lies, m, and a mask.

        The mask says which points lie on the raster; row and column are 0 where one does not.
        """
        row = np.floor((self.north - np.asarray(y, np.float64)) / self.cell)
        column = np.floor((np.asarray(x, np.float64) - self.west) / self.cell)
        rows, columns = self.shape
        there = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        row, column = (np.where(there, each, 0).astype(np.int64) for each in (row, column))
        return row, column, there

    def sampled(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Bilinear values at points of the map, m; arrays that broadcast.

        Beyond the outermost centres, and towards cells without data, it goes on linearly. NaN
        outside the raster, and where the cell in which a point lies has no data.
        """
        column = (np.asarray(x, np.float64) - self.west) / self.cell - 0.5
        row = (np.asarray(y, np.float64) - self.south) / self.cell - 0.5
        return bilinear(self.values[::-1], row, column)
