"""The faces of a fixed box that fluid meets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...record.particles import FIXED, ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.bodies import Box
from ..periodic import periods
from ..shapes import EDGE, Edges, beside_edges, nearest_faces

SLAB = 1  # rows; both faces of so thin a box are as near, so that it has one, which is wet


@dataclass(frozen=True)
class BoxWalls:
    """A fixed box, turned by a matrix (dim, dim), among all particles of a scene."""

    scenario: Scenario
    box: Box
    matrix: np.ndarray
    particles: ParticleSet

    @property
    def thin_axis(self) -> int | None:
        """The axis across which the box is a slab; None for a block."""
        thickness = (self.box.max - self.box.min) / self.scenario.dp
        thin = np.flatnonzero((thickness < SLAB + 0.5) & ~self._is_endless())
        return int(thin[0]) if len(thin) == 1 else None

    def _is_endless(self) -> np.ndarray:
        """Along which axes (dim,) it meets its own image, since it fills a period."""
        period = periods(self.scenario)
        along = np.abs(self.matrix.T @ period)  # exact where an axis of the box is a periodic one
        aligned = np.isclose(np.abs(self.matrix), 1).any(axis=0) & (along > 0)
        return aligned & (self.box.max - self.box.min > along - 0.5 * self.scenario.dp)

    def side_normal(self, axis: int) -> np.ndarray:
        """Unit normal of that side of a slab on which what moves lies."""
        normal = np.zeros(self.scenario.dim)
        normal[axis] = self._side(axis)
        return self.matrix @ normal

    def _side(self, axis: int) -> float:
        """+1 if what moves lies on the upper side of the slab, else -1."""
        middle = 0.5 * (self.box.min[axis] + self.box.max[axis])
        seen = np.array([self._upright(x) for x in movers(self.scenario, self.particles)])
        return 1.0 if len(seen) == 0 or seen[:, axis].mean() >= middle else -1.0

    def nearest_face(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Normal and depth at each position below the nearest face."""
        return nearest_faces(*self._below_faces(position), EDGE * self.scenario.dp)

    def edges(self, position: np.ndarray) -> Edges:
        """The nearest faces."""
        return beside_edges(*self._below_faces(position), EDGE * self.scenario.dp)

    def _below_faces(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Depths (N, m) below the m faces, and their normals (m, dim)."""
        upright = self._upright(position)
        faces = [(a, s) for a in range(self.scenario.dim) for s in (-1.0, 1.0)]
        low, high = self.box.min, self.box.max
        gaps = np.stack(
            [high[a] - upright[:, a] if s > 0 else upright[:, a] - low[a] for a, s in faces], axis=1
        )
        normals = np.array([s * self.matrix[:, a] for a, s in faces])
        return gaps, normals

    def _upright(self, position: np.ndarray) -> np.ndarray:
        """Positions as they would be in the box before its rotation."""
        return (position - self._pivot) @ self.matrix + self._pivot

    @property
    def _pivot(self) -> np.ndarray:
        return self.box.min if self.box.pivot is None else self.box.pivot


def movers(scenario: Scenario, particles: ParticleSet) -> Iterator[np.ndarray]:
    """The middle of what moves, and where it enters; without any, the middle of everything."""
    free = particles.position[particles.motion != FIXED]
    if len(free):
        yield free.mean(axis=0)
    gravity = scenario.gravity
    down = gravity / max(float(np.linalg.norm(gravity)), 1e-300)
    for inflow in scenario.inflow.values():
        yield inflow.position - 1e-3 * inflow.height * down
    if not len(free) and not scenario.inflow:
        yield particles.position.mean(axis=0)
