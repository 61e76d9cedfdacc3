"""Numbers on a regular grid of cells, some without data: between them, averaged, smoothed.

Positions are in cells: 0 is the centre of the first row or column. NaN is "no data".
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.ndimage import correlate1d

MIN_SHARE = 0.5  # of the area of a coarse cell that must have data
TRUNCATE = 4.0  # standard deviations, where the Gaussian ends
EDGE = 1e-9  # cells, by which a point may lie outside by rounding


def bilinear(values: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Values (m, n) at positions that broadcast; NaN outside the cells and in those without data.

    What lacks of the four cells around a point is continued linearly from those beyond them.
    """
    row, column = np.broadcast_arrays(row, column)
    own = _cell_of(row, values.shape[0]), _cell_of(column, values.shape[1])
    inside = (own[0] >= 0) & (own[1] >= 0)
    filled = np.pad(values, 1, constant_values=np.nan)
    for more in (_continued, _continued, _levelled, _levelled):
        filled = more(filled)
    i, a = _between(row, values.shape[0])
    j, b = _between(column, values.shape[1])
    below = (1 - b) * filled[i, j] + b * filled[i, j + 1]
    above = (1 - b) * filled[i + 1, j] + b * filled[i + 1, j + 1]
    found = (1 - a) * below + a * above
    return np.where(inside & ~np.isnan(values[own]), found, np.nan)


def _cell_of(position: np.ndarray, count: int) -> np.ndarray:
    """The cell in which positions lie; -1 outside all (and for NaN)."""
    known = (position >= -0.5 - EDGE) & (position <= count - 0.5 + EDGE)
    cell = np.floor(np.where(known, position, 0.0) + 0.5).astype(np.int64)
    return np.where(known, np.clip(cell, 0, count - 1), -1)


def _between(position: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The padded cell before each position, and how far it is past its centre (0 to 1)."""
    bounded = np.clip(np.nan_to_num(position), -0.5, count - 0.5)
    cell = np.floor(bounded).astype(np.int64)
    return cell + 1, bounded - cell


def _continued(values: np.ndarray) -> np.ndarray:
    """The values, with those that lack continued by one cell: linearly where two in line are known.

    The mean of what the four directions give; so a plane goes on as a plane.
    """
    return _filled(values, lambda near, far: 2 * near - far)


def _levelled(values: np.ndarray) -> np.ndarray:
    """The values, with those that lack the mean of the known ones beside them."""
    return _filled(values, lambda near, _far: near)


def _filled(
    values: np.ndarray, guess: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    total, count = np.zeros_like(values), np.zeros_like(values)
    for axis in (0, 1):
        for step in (1, -1):
            _add(total, count, guess(*(_shifted(values, n * step, axis) for n in (1, 2))))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(np.isnan(values), total / count, values)


def _add(total: np.ndarray, count: np.ndarray, values: np.ndarray) -> None:
    known = ~np.isnan(values)
    total[known] += values[known]
    count[known] += 1


def _shifted(values: np.ndarray, step: int, axis: int) -> np.ndarray:
    """The values `step` cells further along an axis; NaN where there are none."""
    out = np.full_like(values, np.nan)
    to, source = [slice(None)] * 2, [slice(None)] * 2
    to[axis] = slice(None, -step) if step > 0 else slice(-step, None)
    source[axis] = slice(step, None) if step > 0 else slice(None, step)
    out[tuple(to)] = values[tuple(source)]
    return out


def area_mean(values: np.ndarray, shape: tuple[int, int], ratio: float) -> np.ndarray:
    """Mean over coarse cells, `ratio` fine ones wide, of what has data; NaN where half has none."""
    down, across = (_overlap(n, old, ratio) for n, old in zip(shape, values.shape, strict=True))
    known = ~np.isnan(values)
    share = down @ (across @ known.astype(np.float64).T).T
    total = down @ (across @ np.where(known, values, 0.0).T).T
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(share >= MIN_SHARE * (1 - EDGE), total / share, np.nan)


def _overlap(count: int, old: int, ratio: float) -> sparse.csr_matrix:
    """(count, old): the share of each coarse cell that each fine one covers, along one axis."""
    edges = np.minimum(np.arange(count + 1) * ratio, float(old))
    cuts = np.unique(np.concatenate([edges, np.arange(old + 1, dtype=np.float64)]))
    cuts = cuts[cuts <= edges[-1]]
    middle, length = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts)
    coarse = np.clip(np.searchsorted(edges, middle) - 1, 0, count - 1)
    fine = np.minimum(middle.astype(np.int64), old - 1)
    return sparse.csr_matrix((length / np.diff(edges)[coarse], (coarse, fine)), (count, old))


def locally_linear(values: np.ndarray, sigma: float) -> np.ndarray:
    """The plane that fits around each cell with Gaussian weights of `sigma` cells, at the cell."""
    known = ~np.isnan(values)
    level = values[known].mean() if known.any() else 0.0
    weights = known.astype(np.float64)
    heights = np.where(known, values - level, 0.0)
    s = {order: _moment(weights, sigma, order) for order in MOMENTS}
    v = {order: _moment(heights, sigma, order) for order in MOMENTS[:3]}
    return np.where(known, _plane_at_centre(s, v) + level, np.nan)


MOMENTS = ((0, 0), (0, 1), (1, 0), (0, 2), (1, 1), (2, 0))
Moments = dict[tuple[int, int], np.ndarray]


def _moment(values: np.ndarray, sigma: float, order: tuple[int, int]) -> np.ndarray:
    """Sum over the surroundings of values times Gaussian times distance (in sigma) to a power."""
    radius = max(1, round(TRUNCATE * sigma))
    distance = np.arange(-radius, radius + 1) / sigma
    gauss = np.exp(-0.5 * distance**2)
    gauss /= gauss.sum()
    for axis, power in enumerate(order):
        values = correlate1d(values, gauss * distance**power, axis=axis, mode="constant")
    return values


def _plane_at_centre(s: Moments, v: Moments) -> np.ndarray:
    """The weighted least-squares plane at distance 0, by Cramer's rule.

    Where the cells around lie in a line, as those of a profile, it is a straight line along them;
    of one alone it is its value.
    """
    minor = [
        s[2, 0] * s[0, 2] - s[1, 1] ** 2,
        s[1, 0] * s[0, 2] - s[1, 1] * s[0, 1],
        s[1, 0] * s[1, 1] - s[2, 0] * s[0, 1],
    ]
    determinant = s[0, 0] * minor[0] - s[1, 0] * minor[1] + s[0, 1] * minor[2]
    plane = v[0, 0] * minor[0] - v[1, 0] * minor[1] + v[0, 1] * minor[2]
    spread = s[0, 0] * (s[2, 0] + s[0, 2]) - s[1, 0] ** 2 - s[0, 1] ** 2
    line = v[0, 0] * (s[2, 0] + s[0, 2]) - v[1, 0] * s[1, 0] - v[0, 1] * s[0, 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        of_line = np.where(spread > 1e-9 * s[0, 0] ** 2, line / spread, v[0, 0] / s[0, 0])
        return np.where(determinant > 1e-9 * s[0, 0] ** 3, plane / determinant, of_line)
