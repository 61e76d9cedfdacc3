"""Particles as pixels: fast pictures of many particles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

EMPTY = -1


def splat(
    points: np.ndarray, radius: np.ndarray, extent: tuple[float, float, float, float], width: int
) -> np.ndarray:
    """Which particle each pixel shows: an int array (rows from the top, `width`), or EMPTY.

    Every particle is a disc of its `radius` (N,) about its point (N, 2), at least one pixel; later
    ones cover earlier ones.  `extent` is (left, right, bottom, top) in the same unit.
    """
    left, right, bottom, top = extent
    pixel = (right - left) / width
    height = max(1, round((top - bottom) / pixel))
    column = np.floor((points[:, 0] - left) / pixel).astype(int)
    row = np.floor((top - points[:, 1]) / pixel).astype(int)
    image = np.full((height, width), EMPTY)
    pixels = np.maximum(np.round(radius / pixel), 0).astype(int)
    for size in np.unique(pixels):
        members = np.flatnonzero(pixels == size)
        for down, across in _disc(size):
            _paint(image, row[members] + down, column[members] + across, members)
    return image


def _disc(radius: int) -> Iterator[tuple[int, int]]:
    """Offsets (rows, columns) of the pixels of a disc."""
    reach = range(-radius, radius + 1)
    return ((i, j) for i in reach for j in reach if i * i + j * j <= radius * radius)


def _paint(image: np.ndarray, row: np.ndarray, column: np.ndarray, members: np.ndarray) -> None:
    height, width = image.shape
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    image[row[inside], column[inside]] = members[inside]


def coloured(
    image: np.ndarray, colours: np.ndarray, background: tuple[int, int, int]
) -> np.ndarray:
    """The picture (rows, columns, 3) uint8 that gives every particle its colour (N, 3) uint8."""
    palette = np.vstack([colours, np.array([background], np.uint8)])
    return palette[image]  # EMPTY = -1 takes the last entry
