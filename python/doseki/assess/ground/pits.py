"""Pits of a map that are too narrow for particles to fill."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation

from ...scenario.bed import Bed
from ...scenario.tables.terrain.terrain import TERRAIN
from ...util.finding import Finding, place_text
from .sliding import Sliding, Swept

DEEP = 1.2  # spacings below the middle of neighbours on opposite sides
SHARP = 0.5  # curvature times dp; a radius of two spacings


@dataclass(frozen=True)
class NarrowPits(Finding):
    """Nodes of a map at which the ground is rough at the scale of the particles."""

    count: int
    depth: float  # spacings, of the deepest
    at: tuple[float, ...]  # m, of the deepest
    cell: float  # m

    def __str__(self) -> str:
        nodes = "1 node is a pit" if self.count == 1 else f"{self.count:,} nodes are pits"
        return (
            f"{self.place}: {nodes} that particles do not fill, as the one at"
            f" [{place_text(self.at)}] m, {self.depth:.2g} dp deep and with a radius of less than"
            " 2 dp: fluid may get through the ground there; smooth the map, terrain.smoothing ="
            f" {self.cell:.3g}, or lower dp"
        )


def narrow_pits(sliding: Sliding) -> Iterator[Finding]:
    """Pits of the ground that a flow may come over."""
    scenario, bed = sliding.scenario, sliding.scenario.bed
    if bed is None or scenario.is_dry:
        return
    depth = np.where(binary_dilation(bed.unknown, iterations=2), 0.0, pit_depths(bed.heights))
    sharp = 2 * depth * scenario.dp / bed.cell**2 > SHARP
    nodes = np.argwhere(sharp & (depth > DEEP * scenario.dp))
    if not len(nodes):
        return
    swept = sliding.swept
    if swept is None:
        return
    nodes = nodes[_is_near(_places(bed, nodes), swept)]
    if len(nodes):
        deepest = nodes[np.argmax(depth[tuple(nodes.T)])]
        at = tuple(_places(bed, deepest[None])[0].tolist())
        deep = float(depth[tuple(deepest)]) / scenario.dp
        yield NarrowPits(TERRAIN, len(nodes), deep, at, bed.cell)


def pit_depths(heights: np.ndarray) -> np.ndarray:
    """How far each node lies below the middle of its neighbours, the least of all directions, m.

    In a profile a bend is no pit: both neighbours of one must bend the other way.
    """
    found = np.zeros(heights.shape)
    if min(heights.shape) < 3:
        return found
    ways = [(1,)] if heights.ndim == 1 else [(0, 1), (1, 0), (1, 1), (1, -1)]
    middle = heights[(slice(1, -1),) * heights.ndim]
    below = [0.5 * (_moved(heights, way) + _moved(heights, way, -1)) - middle for way in ways]
    found[(slice(1, -1),) * heights.ndim] = np.minimum.reduce(below)
    if heights.ndim == 1:
        rims = np.maximum(np.roll(found, 1), np.roll(found, -1))
        return np.where(rims <= 0, found, 0.0)
    return found


def _moved(heights: np.ndarray, way: tuple[int, ...], sign: int = 1) -> np.ndarray:
    """The neighbours, some way off, of all nodes that are not at the edge."""
    ends = (slice(1 + sign * w, n - 1 + sign * w) for w, n in zip(way, heights.shape, strict=True))
    return heights[tuple(ends)]


def _places(bed: Bed, nodes: np.ndarray) -> np.ndarray:
    """Where nodes are in plan (n, dim - 1), m."""
    return np.asarray(bed.origin + bed.cell * nodes[:, ::-1])


def _is_near(place: np.ndarray, swept: Swept) -> np.ndarray:
    """Mask (n,) of places in the ground that a flow comes over, or a cell away from it."""
    from scipy.spatial import cKDTree

    distance, _ = cKDTree(swept.place).query(place, p=np.inf)
    return np.asarray(distance <= swept.cell)
