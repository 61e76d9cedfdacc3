"""Maps along a path: the bed, and what was on it, against the distance from its first point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...errors import UserError
from ...geodata.grid import Raster
from .quantities import PEAK_DEPTH, QUANTITIES

ROUNDING = 1e-9  # of the length of a path
NO_STEP = 1e-300  # in place of 0, for what runs along an edge
COLUMNS = {"distance": "m", "x": "m", "y": "m", "bed": "m"} | {q.name: q.unit for q in QUANTITIES}


def along_path(maps: Mapping[str, Raster], bed: Raster, path: np.ndarray) -> dict[str, np.ndarray]:
    """COLUMNS at points of a path (n, 2) on the map, m, one cell apart, and at its vertices.

    Of maps it is the value of the cell in which a point lies, for a peak is that of its cell; the
    bed is bilinear. NaN where a point lies outside, or there are no data.

    Raises:
        UserError: the path has no length, or none of it lies on the map.

    """
    steps = np.hypot(*np.diff(path, axis=0).T)
    at_vertex = np.concatenate([[0.0], np.cumsum(steps)])
    if len(path) < 2 or not at_vertex[-1] > 0:
        raise UserError("the path of a profile needs two points that differ")
    between = np.arange(bed.cell / 2, at_vertex[-1], bed.cell)
    distance = np.unique(np.concatenate([between, at_vertex]))
    x, y = (np.interp(distance, at_vertex, path[:, axis]) for axis in (0, 1))
    row, column, inside = bed.cells_at(x, y)
    if not inside.any():
        edges = [f"from {low:.10g} to {high:.10g} m" for low, high in _sides(bed)]
        raise UserError(
            "the path of the profile lies beside the map, which has x " + " and y ".join(edges)
        )
    found = {"distance": distance, "x": x, "y": y, "bed": bed.sampled(x, y)}
    for quantity in QUANTITIES:
        values = np.full(len(distance), np.nan)
        values[inside] = maps[quantity.name].values[row[inside], column[inside]]
        found[quantity.name] = values
    return found


def _sides(bed: Raster) -> Iterator[tuple[float, float]]:
    """The ends of a map along x and along y, m."""
    west, south, east, north = bed.extent
    yield west, east
    yield south, north


def beside_map(bed: Raster, path: np.ndarray) -> Iterator[str]:
    """A sentence about a path (n, 2) of which a part lies beside the map; none where all is on it.

    A cell without data is on the map.
    """
    whole = float(np.hypot(*np.diff(path, axis=0).T).sum())
    beside = whole - _length_within(bed, path)
    if beside > ROUNDING * whole:
        yield (
            f"along the path: {beside:.4g} of its {whole:.4g} m lie beside the map, where "
            "nothing is known"
        )


def _length_within(bed: Raster, path: np.ndarray) -> float:
    """How long a path is within the edges of the map, m."""
    low, high = np.reshape(bed.extent, (2, 2))
    start, step = path[:-1], np.diff(path, axis=0)
    slope = np.where(step == 0, NO_STEP, step)
    with np.errstate(over="ignore"):
        crossed = np.sort([(low - start) / slope, (high - start) / slope], axis=0)
    enters, leaves = crossed[0].max(axis=1), crossed[1].min(axis=1)
    share = np.clip(leaves, 0, 1) - np.clip(enters, 0, 1)
    return float(np.maximum(share, 0.0) @ np.hypot(*step.T))


def path_lines(profile: Mapping[str, np.ndarray]) -> Iterator[str]:
    """The run-out along the path as a sentence: from the first point that was reached to the last.

    Its angle is that of the line between them, with the distance along the path.
    """
    reached = np.flatnonzero(profile[PEAK_DEPTH.name] > 0)
    if not len(reached):
        yield "along the path: nothing was reached"
        return
    start, end = ((profile["distance"][k], profile["bed"][k]) for k in (reached[0], reached[-1]))
    length = end[0] - start[0]
    text = f"along the path: reached from {start[0]:.4g} to {end[0]:.4g} m"
    if length > 0 and np.isfinite(start[1] - end[1]):
        text += _angle_text(float(np.degrees(np.arctan2(start[1] - end[1], length))))
    yield text


def _angle_text(angle: float) -> str:
    """What is said of an angle below the horizontal, degrees."""
    if angle >= 0:
        return f", at {angle:.3g} degrees"
    return (
        f", which lies {-angle:.3g} degrees uphill: the angle of a run-out is that of a path drawn "
        "from the release down to the deposit"
    )
