"""Walls through which water on both sides would feel one another.  Lengths in m."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...util.finding import Finding, no_more_than, percent
from ..shapes import MeshShape

SHARE = 0.01  # of the surface; on less of it a wall may be thinner, as beside a sharp edge
PLACES = 4000  # of the surface that are looked at
OPPOSITE = -0.7  # cosine of the angle between the two sides of a wall
EXACT = 1e-6  # of a thickness


@dataclass(frozen=True)
class ThinWall(Finding):
    """A mesh with walls that are thinner than the kernel sees."""

    thickness: float  # m, the least
    needed: float  # m
    share: float  # of the surface
    spacing: float  # m

    def __str__(self) -> str:
        enough = no_more_than(self.spacing * self.thickness / self.needed)
        holes = ", and leaks where it is thinner than dp" if self.thickness < self.spacing else ""
        return (
            f"{self.place}: {percent(self.share)} of its surface is that of walls down to "
            f"{self.thickness:.3g} m thick; the kernel sees {self.needed:.3g} m, so that water on "
            f"one side feels the water on the other{holes}: dp = {enough} would do, or a thicker "
            "wall"
        )


def thin_walls(place: str, shape: MeshShape, spacing: float, needed: float) -> Iterator[ThinWall]:
    """At most one for the body of that name, which needs so much, m."""
    if shape.thickness:
        if shape.thickness < needed * (1 - EXACT):
            yield ThinWall(place, shape.thickness, needed, 1.0, spacing)
        return
    position, normal = _places(shape)
    other, depth = shape.wall(position - 0.5 * needed * normal, spacing)
    opposite = (other * normal).sum(axis=1) < OPPOSITE
    # So deep that the far side is nearer than the one they were put below.
    thickness = 0.5 * needed + depth
    thin = opposite & (thickness < needed * (1 - EXACT)) & (thickness > 0)
    share = float(thin.mean())
    if share > SHARE:
        yield ThinWall(place, float(thickness[thin].min()), needed, share, spacing)


def _places(shape: MeshShape) -> tuple[np.ndarray, np.ndarray]:
    """Points (PLACES, 3) evenly over the surface, and the normals there."""
    area = shape.mesh.areas
    size = np.linalg.norm(area, axis=1)
    random = np.random.default_rng(0)
    which = np.searchsorted(np.cumsum(size) / size.sum(), (np.arange(PLACES) + 0.5) / PLACES)
    which = np.minimum(which, len(size) - 1)
    weight = random.dirichlet(np.ones(3), PLACES)
    position = np.einsum("nk,nkd->nd", weight, shape.mesh.corners[which])
    return position, area[which] / size[which][:, None]
