"""Whether bodies lie on something: on walls, or on other bodies that do."""

from __future__ import annotations

import numpy as np

from .pouring import Cells, Fall

MAX_RAYS = 2000
DIRECTIONS = 32  # in which the sides of a centre of mass are looked at, in 3-D


def falling(cells: Cells, points: np.ndarray, speed: float, fall: Fall) -> float:
    """Share of what starts at the points (n, dim) with that speed below which there is nothing."""
    return float(np.mean(cells.lets_fall(_some(points), speed, fall)))


def supports(cells: Cells, points: np.ndarray, speed: float, fall: Fall) -> np.ndarray:
    """Mask of the rays from a body that meet what may hold it.

    What is in the cells of its sides is beside it, not below.
    """
    rays = _some(points)
    rim = _rim(rays, fall, cells.cell)
    beside = rim & cells.is_wall(rays) if not rim.all() else np.zeros(len(rays), bool)
    return ~cells.lets_fall(rays, speed, fall) & ~beside


def holds(cells: Cells, points: np.ndarray, met: np.ndarray, fall: Fall) -> bool:
    """Whether the rays that met something do so on each side of the centre of mass of a body."""
    if not met.any():
        return False
    centre, sides = points.mean(axis=0), _sides(fall.down)
    return bool(((_some(points)[met] - centre) @ sides.T).max(axis=0).min() >= -cells.cell)


def _some(points: np.ndarray) -> np.ndarray:
    return points[:: len(points) // MAX_RAYS + 1]


def _rim(points: np.ndarray, fall: Fall, width: float) -> np.ndarray:
    """Mask (n,) of the points at the sides of a body."""
    aside = points @ _sides(fall.down).T
    return np.asarray((aside > aside.max(axis=0) - width).any(axis=1))


def _sides(down: np.ndarray) -> np.ndarray:
    """Unit vectors (m, dim) all around, normal to `down`."""
    level = np.linalg.svd(down[None, :])[2][1:]
    if len(level) == 1:
        return np.concatenate([level, -level])
    angle = np.arange(DIRECTIONS) * 2 * np.pi / DIRECTIONS
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) @ level
