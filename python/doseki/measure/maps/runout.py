"""How far a flow went: area covered, deposit, and the angle of its run-out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...geodata.grid import Raster
from .files import reached
from .flows import Flows, flows_on
from .grid import SPEED_DEPOSIT, MapSettings
from .quantities import DEPOSIT

LITTLE = 1e-3  # of a volume
NEARLY = 1 - 1e-6  # of a cell, by which a flow must have left where it was first seen
EDGE, HOLE = "the edge of the map", "cells without data"


@dataclass(frozen=True)
class Runout:
    """How far a flow went.

    Attributes:
        area: that a flow covered at any time, m2, without still water.
        deposit_area: m2.
        deposit_volume: m3.
        top: x, y, z of the highest cell that was covered when the flow was first seen, m.
        toe: x, y, z of the cell of the flow that is farthest from there on the map, m.
        distance: between them on the map, m.
        angle: of the line from top to toe, degrees (Heim's Fahrboeschung).
        ends_at: EDGE or HOLE where the toe touches these, so that the flow may have gone on.
        still_area: of water that never moved, m2.
        still_volume: of it, which is in that of the deposit, m3.
        beside_deposit: volumes that are not in the deposit, m3, as peaks.beside_deposit has them;
            None where they are not known.

    Top, toe, distance and angle are None where the run has no terrain, or nothing flows. Toe,
    distance and angle are also None while the flow reaches less than a cell farther from the top
    than it did when it was first seen, and the angle where the toe is as high as the top, or
    higher. Of several flows it is the one with the largest distance.

    """

    area: float
    deposit_area: float
    deposit_volume: float
    top: tuple[float, float, float] | None = None
    toe: tuple[float, float, float] | None = None
    distance: float | None = None
    angle: float | None = None
    ends_at: str | None = None
    still_area: float = 0.0
    still_volume: float = 0.0
    beside_deposit: Mapping[str, float] | None = None


def runout(maps: Mapping[str, Raster], bed: Raster, rest: float = SPEED_DEPOSIT) -> Runout:
    """From maps on the grid of `bed`, the heights of the terrain.

    What is slower than `rest`, m/s, does not move.
    """
    flows, square = flows_on(maps, rest), bed.cell**2
    lying = np.nan_to_num(maps[DEPOSIT.name].values)
    found = Runout(
        area=float((reached(maps) & ~flows.still).sum() * square),
        deposit_area=float(np.count_nonzero(lying) * square),
        deposit_volume=float(lying.sum() * square),
        still_area=float(flows.still.sum() * square),
        still_volume=float(lying[flows.still].sum() * square),
    )
    numbers = np.unique(flows.flow[(flows.start > 0) & ~np.isnan(bed.values)])
    lines = [_line(flows, number, bed) for number in numbers]
    if not lines:
        return found
    return replace(
        found, **max(lines, key=lambda line: (line.get("distance", 0.0), line["top"][2]))
    )


def _line(flows: Flows, number: int, bed: Raster) -> dict[str, Any]:
    """Top, and if it has left its beginning toe, distance and angle of one flow."""
    own = (flows.flow == number) & ~np.isnan(bed.values)
    x, y = np.meshgrid(bed.x, bed.y)
    heights = np.where(own & (flows.start > 0), bed.values, -np.inf)
    top = np.unravel_index(np.argmax(heights), bed.shape)
    away = np.where(own, np.hypot(x - x[top], y - y[top]), -1.0)
    toe = np.unravel_index(np.argmax(away), bed.shape)
    points = [(float(x[at]), float(y[at]), float(bed.values[at])) for at in (top, toe)]
    distance = float(away[toe])
    if distance < float(away[flows.start == flows.start[top]].max()) + bed.cell * NEARLY:
        return {"top": points[0]}
    drop = points[0][2] - points[1][2]
    angle = math.degrees(math.atan2(drop, distance)) if drop > 0 else None
    found = {"top": points[0], "toe": points[1], "distance": distance, "angle": angle}
    return found | {"ends_at": _end(bed, int(toe[0]), int(toe[1]))}


def _end(bed: Raster, row: int, column: int) -> str | None:
    """What a cell touches beyond which nothing is known."""
    rows, columns = bed.shape
    if row in (0, rows - 1) or column in (0, columns - 1):
        return EDGE
    around = bed.values[row - 1 : row + 2, column - 1 : column + 2]
    return HOLE if np.isnan(around).any() else None


def runout_lines(found: Runout, settings: MapSettings) -> Iterator[str]:
    """Area, deposit and run-out as sentences; `settings` are those of the maps."""
    lying = f"{found.deposit_volume:.4g} m3 lie on {found.deposit_area:.4g} m2"
    yield f"covered {found.area:.4g} m2; {lying}"
    yield from _beside_lines(found, settings)
    if found.still_area:
        yield (
            f"{found.still_volume:.4g} m3 of what lies never moved: still water on "
            f"{found.still_area:.4g} m2, which do not count as covered"
        )
    if found.top is None:
        return
    if found.toe is None:
        yield "no run-out: the flow reaches no farther than it did when it was first seen"
        return
    least = "at least " if found.ends_at else ""
    how = "not downhill" if found.angle is None else f"at {found.angle:.3g} degrees"
    line = f"run-out {least}{found.distance:.4g} m {how}, from {_point(found.top)}"
    line += f" to {_point(found.toe)}"
    if found.ends_at:
        line += f", at {found.ends_at}: the flow may go on there"
    yield line


def _beside_lines(found: Runout, settings: MapSettings) -> Iterator[str]:
    """What is not in the deposit, and why, where that is not next to nothing."""
    beside = found.beside_deposit or {}
    total = sum(beside.values())
    if not total > LITTLE * (found.deposit_volume + total):
        return
    why = {
        "moving": f"faster than {settings.speed_deposit:g} m/s",
        "thin": f"in cells less than {settings.dry_below:.3g} m deep (maps.min_depth)",
        "beside": "beside the map",
    }
    told = [
        f"{beside[key]:.4g} m3 {words}"
        for key, words in why.items()
        if beside.get(key, 0.0) > LITTLE * total
    ]
    yield f"not in the deposit: {', '.join(told)}"


def _point(point: tuple[float, float, float]) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f}, {point[2]:.1f}) m"
