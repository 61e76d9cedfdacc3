"""Walls for the resolved scheme: a normal into the fluid and a depth for each particle."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .bodies import field_of
from .grains import SOLID_SHAPES
from .lattice import rotation_matrix
from .particles import FIXED, ParticleSet
from .scenario import Scenario
from .schema import Box, Disc, LatticeBody, ShapedBody

SLAB = 8  # spacings; a box thinner than this along one axis alone is a slab with one wet face


def wall_geometry(scenario: Scenario, particles: ParticleSet, names: list[str]) -> tuple:
    """Normals (N, dim) into the fluid and depths (N,) below it, m.

    Zero where not fixed, and for the fixed bodies whose particles bring their own.
    """
    normal, depth = np.zeros_like(particles.position), np.zeros(len(particles))
    for name, body in scenario.body.items():
        of_it = (particles.motion == FIXED) & (particles.body == names.index(name))
        if of_it.any() and not isinstance(body, SOLID_SHAPES):
            wall = _Wall(scenario, name, body, particles)
            normal[of_it], depth[of_it] = wall.of(particles.position[of_it])
    return normal, depth


class _Wall:
    """One fixed body and the way it faces."""

    def __init__(
        self, scenario: Scenario, name: str, body: ShapedBody, particles: ParticleSet
    ) -> None:
        self.scenario, self.name, self.body, self.particles = scenario, name, body, particles

    def of(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Normal and depth at each position."""
        given = getattr(self.body, "normal", None)
        if given is not None:
            return self._along(position, given / np.linalg.norm(given))
        if getattr(self.body, "where", None) is not None:
            return self._carved(position)
        if isinstance(self.body, Box):
            return self._box(position)
        if isinstance(self.body, Disc):
            out = position - self.body.centre
            distance = np.linalg.norm(out, axis=1)
            unit = out / np.maximum(distance, 1e-300)[:, None]
            return unit, self.body.radius - distance
        raise self.scenario.where.error(
            ("body", self.name),
            f"body.{self.name}: a wall of points needs its normal = [...] into the fluid",
        )

    def _carved(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A surface where the body's `where` is zero: its gradient points into the wall."""
        step = 1e-3 * self.scenario.dp
        inside = self._where(position)
        gradient = np.stack(
            [
                (self._where(position + shift) - self._where(position - shift)) / (2 * step)
                for shift in step * np.eye(self.scenario.dim)
            ],
            axis=1,
        )
        slope = np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
        return -gradient / slope[:, None], inside / slope

    def _where(self, position: np.ndarray) -> np.ndarray:
        return field_of(self.scenario, self.name, "where", self.body.where, position)

    def _along(self, position: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A plane wall: its surface is half a spacing beyond the foremost particles."""
        along = position @ normal
        surface = along.max() + 0.5 * (getattr(self.body, "dp", None) or self.scenario.dp)
        return np.tile(normal, (len(position), 1)), surface - along

    def _box(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A slab faces what moves; a block faces outwards, each particle to its nearest face."""
        low, high = self.body.min, self.body.max
        thickness = (high - low) / self.scenario.dp
        matrix = self._rotation()
        thin = np.flatnonzero(thickness < SLAB + 0.5)
        if len(thin) == 1:
            axis = np.zeros(self.scenario.dim)
            axis[thin[0]] = self._side(thin[0], matrix)
            return self._along(position, matrix @ axis)
        upright = (position - self._pivot()) @ matrix + self._pivot()
        return self._nearest_face(upright, matrix)

    def _side(self, axis: int, matrix: np.ndarray) -> float:
        """+1 if what moves lies on the upper side of the slab, else -1."""
        middle = 0.5 * (self.body.min[axis] + self.body.max[axis])
        seen = np.array([(x - self._pivot()) @ matrix + self._pivot() for x in self._movers()])
        return 1.0 if len(seen) == 0 or seen[:, axis].mean() >= middle else -1.0

    def _movers(self) -> Iterator[np.ndarray]:
        """The middle of what moves, and where it enters; without any, the middle of everything."""
        free = self.particles.position[self.particles.motion != FIXED]
        if len(free):
            yield free.mean(axis=0)
        for inflow in self.scenario.inflow.values():
            yield np.asarray(inflow.position, float) - 1e-3 * inflow.depth * _unit(
                self.scenario.gravity
            )
        if not len(free) and not self.scenario.inflow:
            yield self.particles.position.mean(axis=0)

    def _nearest_face(
        self, upright: np.ndarray, matrix: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        dim = self.scenario.dim
        faces = [(a, s) for a in range(dim) for s in (-1.0, 1.0) if not self._covered(a, s, matrix)]
        faces = faces or [(dim - 1, 1.0)]
        low, high = self.body.min, self.body.max
        gaps = np.stack(
            [high[a] - upright[:, a] if s > 0 else upright[:, a] - low[a] for a, s in faces], axis=1
        )
        nearest = gaps.argmin(axis=1)
        normals = np.array([s * matrix[:, a] for a, s in faces])
        return normals[nearest], gaps[np.arange(len(gaps)), nearest]

    def _covered(self, axis: int, side: float, matrix: np.ndarray) -> bool:
        """Whether other walls lie against the middle of a face."""
        centre = 0.5 * (self.body.min + self.body.max)
        centre[axis] = (self.body.max if side > 0 else self.body.min)[axis]
        centre[axis] += 0.5 * side * self.scenario.dp
        centre = self._pivot() + matrix @ (centre - self._pivot())
        fixed = self.particles.position[self.particles.motion == FIXED]
        return bool((np.abs(fixed - centre).max(axis=1) < 0.76 * self.scenario.dp).any())

    def _rotation(self) -> np.ndarray:
        if not isinstance(self.body, LatticeBody) or self.body.rotate == 0:
            return np.eye(self.scenario.dim)
        return rotation_matrix(self.body.rotate, self.scenario.dim, self.body.rotate_axis)

    def _pivot(self) -> np.ndarray:
        return self.body.min if self.body.pivot is None else self.body.pivot


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / max(float(np.linalg.norm(vector)), 1e-300)
