"""Maps whose heights come in steps, as those of whole metres: treads and risers for a slope."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..geodata.raster import Raster

STEPS = (10.0, 5.0, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02, 0.01)  # m, that are looked for
NEARLY_ALL = 0.99  # of the heights are multiples of the step
ROUNDING = 1e-3  # steps, by which numbers of 4 bytes may miss one
LEVELS = 5  # with fewer it is a floor with walls
BENDS = 0.02  # of the cells; with fewer it is a plane
ROUGH = 2.0  # steps: ground that bends by more from cell to cell hides them
CELLS, TREADS = 2.0, 0.5  # over which a Gaussian evens steps out


@dataclass(frozen=True)
class Terraces:
    """Heights in steps of `step`, m, which smoothing over `length`, m, evens out."""

    step: float
    length: float


def terraces_of(raster: Raster) -> Terraces | None:
    """The steps of a map, unless its ground is rough enough to hide them."""
    heights = raster.values[np.isfinite(raster.values)]
    step = next((s for s in STEPS if _come_in(heights, s)), None)
    if step is None or np.ptp(heights) < (LEVELS - 1.5) * step:
        return None
    bends = np.concatenate([np.diff(raster.values, 2, axis=axis).ravel() for axis in (0, 1)])
    bends = np.abs(bends[np.isfinite(bends)])
    bent = bends[bends > 0.5 * step]
    if len(bent) < BENDS * len(bends) or np.median(bent) > ROUGH * step:
        return None
    rises = [np.nanmean(np.abs(np.diff(raster.values, axis=axis))) for axis in (0, 1)]
    tread = step * raster.cell / math.hypot(*rises)
    return Terraces(step, max(CELLS * raster.cell, TREADS * tread))


def _come_in(heights: np.ndarray, step: float) -> bool:
    """Whether nearly all heights are multiples of a step."""
    near = np.abs(heights / step - np.round(heights / step)) < ROUNDING
    return bool(np.mean(near) >= NEARLY_ALL)
