"""How far a flow went: area covered, deposit, and the angle of its run-out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ...geodata.grid import Raster
from .files import reached
from .quantities import ARRIVAL_TIME, DEPOSIT

NEARLY = 1 - 1e-6  # of a cell, by which a flow must have left where it was first seen


@dataclass(frozen=True)
class Runout:
    """How far a flow went.

    Attributes:
        area: covered at any time, m2.
        deposit_area: m2.
        deposit_volume: m3.
        top: x, y, z of the highest cell that was covered when the flow was first seen, m.
        toe: x, y, z of the covered cell that is farthest from there on the map, m.
        distance: between them on the map, m.
        angle: of the line from top to toe, degrees (Heim's Fahrboeschung).

    The last four are None where the run has no terrain, or nothing flows. Toe, distance and angle
    are also None while the flow reaches less than a cell farther from the top than it did when it
    was first seen, and the angle where the toe is as high as the top, or higher.

    """

    area: float
    deposit_area: float
    deposit_volume: float
    top: tuple[float, float, float] | None = None
    toe: tuple[float, float, float] | None = None
    distance: float | None = None
    angle: float | None = None


def runout(maps: Mapping[str, Raster], bed: Raster) -> Runout:
    """From maps on the grid of `bed`, the heights of the terrain."""
    covered, square = reached(maps), bed.cell**2
    lying = np.nan_to_num(maps[DEPOSIT.name].values)
    areas = (
        float(covered.sum() * square),
        float(np.count_nonzero(lying) * square),
        float(lying.sum() * square),
    )
    known = covered & ~np.isnan(bed.values)
    if not known.any():
        return Runout(*areas)
    x, y = np.meshgrid(bed.x, bed.y)
    arrival = maps[ARRIVAL_TIME.name].values
    first = known & (arrival == np.nanmin(arrival[known]))
    top = np.unravel_index(np.argmax(np.where(first, bed.values, -np.inf)), bed.shape)
    away = np.where(known, np.hypot(x - x[top], y - y[top]), -1.0)
    toe = np.unravel_index(np.argmax(away), bed.shape)
    points = [(float(x[at]), float(y[at]), float(bed.values[at])) for at in (top, toe)]
    distance = float(away[toe])
    if distance < float(away[first].max()) + bed.cell * NEARLY:
        return Runout(*areas, points[0])
    drop = points[0][2] - points[1][2]
    angle = math.degrees(math.atan2(drop, distance)) if drop > 0 else None
    return Runout(*areas, points[0], points[1], distance, angle)


def runout_lines(found: Runout) -> Iterator[str]:
    """Area, deposit and run-out as sentences."""
    lying = f"{found.deposit_volume:.4g} m3 lie on {found.deposit_area:.4g} m2"
    yield f"covered {found.area:.4g} m2; {lying}"
    if found.top is None:
        return
    if found.toe is None:
        yield "no run-out: the flow reaches no farther than it did when it was first seen"
        return
    how = "not downhill" if found.angle is None else f"at {found.angle:.3g} degrees"
    yield (f"run-out {found.distance:.4g} m {how}, from {_point(found.top)} to {_point(found.toe)}")


def _point(point: tuple[float, float, float]) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f}, {point[2]:.1f}) m"
