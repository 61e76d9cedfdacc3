"""The terrain of a run as a grid of heights for a view."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .box import Box
from .coding import packed

MOST_NODES = 500  # along a side
NO_DATA = 65535  # in place of a height
STEPS = NO_DATA - 1  # between the lowest and the highest place
CONTOURS = 25  # about so many between them


class Heights(Protocol):
    """A raster, as geodata.grid has it."""

    @property
    def values(self) -> np.ndarray:
        """Heights (rows, columns), m, from north to south; NaN: no data."""

    @property
    def x(self) -> np.ndarray:
        """Centres of the columns, m."""

    @property
    def y(self) -> np.ndarray:
        """Centres of the rows, m."""


@dataclass(frozen=True)
class Grid:
    """Heights (rows, columns), m, from south to north, at places `x` and `y`, m."""

    heights: np.ndarray
    x: np.ndarray
    y: np.ndarray
    step: int  # every so many nodes of the raster

    @property
    def corners(self) -> list[np.ndarray]:
        """Lower and upper corner (3,), m; none without any height."""
        if not np.isfinite(self.heights).any():
            return []
        low, high = np.nanmin(self.heights), np.nanmax(self.heights)
        ends = (self.x[0], self.y[0], low), (self.x[-1], self.y[-1], high)
        return [np.array(end) for end in ends]

    def as_json(self, box: Box, name: str) -> dict[str, Any]:
        """For the page; its numbers are in the block `name`."""
        (west, south, low), (east, north, high) = (end.tolist() for end in self.corners)
        rows, columns = self.heights.shape
        origin = np.array([west, south, low]) - box.corner
        spacing = [(east - west) / max(1, columns - 1), (north - south) / max(1, rows - 1)]
        return {
            "id": name,
            "columns": columns,
            "rows": rows,
            "origin": origin.tolist(),
            "spacing": [*spacing, high - low],
            "interval": contour_interval(high - low),
            "base": float(box.corner[2]),
        }

    def text(self) -> str:
        """Its heights as a block."""
        low, high = np.nanmin(self.heights), np.nanmax(self.heights)
        share = (self.heights - low) / ((high - low) or 1.0)
        steps = np.where(np.isfinite(share), np.rint(STEPS * np.nan_to_num(share)), NO_DATA)
        return packed([steps.astype(np.uint16).ravel()])


def grid_of(raster: Heights) -> Grid:
    """The nodes of a raster, every second or third of one that is large."""
    step = math.ceil(max(raster.values.shape) / MOST_NODES)
    heights = raster.values[::-1][::step, ::step]
    return Grid(heights, raster.x[::step], raster.y[::-1][::step], step)


def contour_interval(height: float) -> float:
    """1, 2 or 5 times a power of ten, m: about CONTOURS lines over `height`, m."""
    if height <= 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(height / CONTOURS))
    return next(digit * power for digit in (1, 2, 5, 10) if digit * power * CONTOURS >= height)
