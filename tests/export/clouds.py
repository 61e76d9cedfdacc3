"""Lattices of particles, and the surfaces that are found around them."""

from __future__ import annotations

import numpy as np

from doseki.export.surface.contour import contour
from doseki.export.surface.fraction import Cloud, Grid, blocks

KERNEL, REACH = "wendland_c2", 2.78  # spacings


def lattice(low, high, dp):
    """Particles (n, dim) in the middles of cells of side `dp` that fill a box."""
    axes = [np.arange(a + dp / 2, b, dp) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def ball(dp, dim=3, radius=1.0):
    """Those whose middles are in a ball."""
    points = lattice([-1.1 * radius] * dim, [1.1 * radius] * dim, dp)
    return points[(points**2).sum(axis=1) < radius**2]


def cloud_of(points, dp, solid=None):
    """A cloud of particles of spacing `dp`."""
    n = len(points)
    solid = np.zeros(n, bool) if solid is None else solid
    return Cloud(points, np.full(n, dp ** points.shape[1]), np.full(n, REACH * dp), solid)


def surface(points, dp, solid=None, level=0.5, cell=0.5, periods=()):
    """The surface of a cloud, in cells of so many spacings."""
    grid = Grid(cell * dp, level, KERNEL, periods)
    return contour(blocks(cloud_of(points, dp, solid), grid), grid.cell, points.shape[1])
