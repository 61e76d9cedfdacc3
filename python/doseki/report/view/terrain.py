"""The terrain of a run as a grid of heights for a view."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .box import Box
from .coding import packed

MOST_NODES = 500  # along a side
MOST_PLACES = 4000  # along a profile
SOIL = 0.05  # of the length of a profile: so much ground is drawn below its lowest place
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
    """Heights (rows, columns), m, from south to north, at places `x` and `y`, m.

    Of a 2-D run both rows are at y = 0: what is between them is the ground as it is cut.
    """

    heights: np.ndarray
    x: np.ndarray
    y: np.ndarray
    step: int = 1  # every so many nodes of the raster
    dim: int = 3

    @property
    def corners(self) -> list[np.ndarray]:
        """Lower and upper corner (dim,), m; none without any height."""
        if not np.isfinite(self.heights).any():
            return []
        low, high = np.nanmin(self.heights), np.nanmax(self.heights)
        ends = (self.x[0], self.y[0], low), (self.x[-1], self.y[-1], high)
        return [np.array(end if self.dim == 3 else end[::2]) for end in ends]

    def as_json(self, box: Box, name: str) -> dict[str, Any]:
        """For the page; its numbers are in the block `name`."""
        low, high = self.corners
        rows, columns = self.heights.shape
        origin = np.zeros(3)
        origin[: self.dim] = low - box.corner[: self.dim]
        counts = max(1, columns - 1), max(1, rows - 1)
        spacing = [(at[-1] - at[0]) / n for at, n in zip((self.x, self.y), counts, strict=True)]
        return {
            "id": name,
            "columns": columns,
            "rows": rows,
            "origin": origin.tolist(),
            "spacing": [*spacing, high[-1] - low[-1]],
            "upright": self.dim == 2,
            "interval": contour_interval(high[-1] - low[-1]),
            "base": float(box.corner[self.dim - 1]),
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


def grid_below(x: np.ndarray, z: np.ndarray) -> Grid:
    """The ground below a profile, heights `z` (N,) at places `x` (N,) that rise, m."""
    even = np.linspace(x[0], x[-1], min(len(x), MOST_PLACES))
    surface = np.interp(even, x, z)
    below = np.full(len(even), surface.min() - SOIL * (x[-1] - x[0]))
    return Grid(np.stack([below, surface]), even, np.zeros(2), dim=2)


def contour_interval(height: float) -> float:
    """1, 2 or 5 times a power of ten, m: about CONTOURS lines over `height`, m."""
    if height <= 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(height / CONTOURS))
    return next(digit * power for digit in (1, 2, 5, 10) if digit * power * CONTOURS >= height)
