"""Discs and spheres.  Their particles have the symmetries of the square or the cube."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from ..lattices import ROUNDING, ball_measure
from .balance import balanced
from .particles import Curve, Particles, alike, from_centre
from .surface import PARTS, SurfaceVertices, on_sphere


@dataclass(frozen=True)
class Ball:
    """A disc (dim = 2) or sphere (dim = 3); fluid meets it at `wetted` times its radius."""

    radius: float
    dim: int
    wetted: float = 1.0

    @property
    def measure(self) -> float:
        """Area, m2, or volume, m3."""
        return ball_measure(self.radius, self.dim)

    @property
    def wet_measure(self) -> float:
        """Area or volume that fluid cannot enter."""
        return ball_measure(self.wetted * self.radius, self.dim)

    @property
    def inertia(self) -> np.ndarray:
        """Inertia tensor (3, 3) over the mass, m2; of a disc only [2, 2]."""
        square = self.radius**2
        return np.diag([0, 0, square / 2]) if self.dim == 2 else 0.4 * square * np.eye(3)

    @property
    def width(self) -> float:
        """Smallest extent."""
        return 2 * self.radius

    @property
    def reach(self) -> float:
        """Radius of the circumscribed ball."""
        return self.radius

    def particles(self, dp: float) -> Particles:
        """Concentric rings or shells dp apart, the outermost dp/2 below the surface.

        Each shares the measure that is nearer to it than to the others.
        """
        radius = self.radius * self.wetted
        outermost = radius - 0.5 * dp
        if outermost < 0.25 * dp:
            return self.single()
        radii = _ring_radii(outermost, dp)
        edges = np.append(0.5 * (radii[1:] + radii[:-1]), radius)
        measures = np.diff([0.0, *(ball_measure(r, self.dim) for r in edges)])
        position, share = [], []
        for k, (r, measure) in enumerate(zip(radii, measures, strict=True)):
            number = measure / dp**self.dim if r > 0 else 1.0
            unit, part = _directions(number, self.dim, k % 2 == 1)
            position.append(r * unit)
            share.append(part * measure / measures.sum())
        return from_centre(
            np.concatenate(position), radius, np.concatenate(share), self._curvature(dp)
        )

    def elastic_particles(self, dp: float) -> Particles:
        """A disc as rings of 6, 12, 18 ... particles around one, a hexagonal lattice that is bent.

        Any two such discs meet point to point along x. Balls of the diameter of a particle in the
        outermost ring touch the circle from inside. All but the two outermost rings lie so that an
        even stress is in balance.
        """
        if self.dim == 3:
            ball = self.particles(dp)
            return ball._replace(share=alike(len(ball.share)))
        position = self.radius * _even_rings(max(1, round(self.radius / dp)))
        return from_centre(position, self.radius, alike(len(position)), self._curvature(dp))

    def curve(self, dp: float) -> Curve:
        """The circle, with a vertex for each particle of the outermost ring; off by 1e-6."""
        number = 6 * max(1, round(self.radius / dp))
        angle = 2 * np.pi * np.arange(number) / number
        radius = self.radius * 3 / (2 + np.cos(angle[1]))
        vertex = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return Curve(vertex, np.zeros(number, bool))

    def surface(self, dp: float) -> SurfaceVertices:
        """What a deformable sphere touches with."""
        return on_sphere(self.radius, _shell(4 * np.pi * (PARTS * self.radius / dp) ** 2), dp)

    def contains(self, position: np.ndarray) -> np.ndarray:
        """Whether positions (N, dim) lie inside."""
        radius = self.wetted * self.radius * (1 - ROUNDING)
        return (position**2).sum(axis=1) < radius**2

    def single(self) -> Particles:
        """One particle in the centre."""
        return from_centre(np.zeros((1, self.dim)), self.wetted * self.radius, np.ones(1))

    def _curvature(self, dp: float) -> float:
        """Of the circles on which the first row of fluid slides around it, 1/m."""
        return 1 / (self.wetted * self.radius + 0.5 * dp)

    def table(self, dp: float) -> dict[str, Any]:
        """The shape as the core reads it."""
        return {"radius": self.radius}


@lru_cache(maxsize=16)
def _even_rings(number: int) -> np.ndarray:
    """Particles (n, 2) of so many rings in a disc of radius 1."""
    spacing = np.sqrt(np.pi / (3 * number * (number + 1) + 1))
    step = (1 - 0.5 * spacing) / number
    ring = np.repeat(np.arange(number + 1), [1, *(6 * k for k in range(1, number + 1))])
    place = np.arange(len(ring)) - (3 * ring * (ring - 1) + 1)
    angle = np.pi / 3 * place / np.maximum(ring, 1)
    out = np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def symmetrised(shift: np.ndarray) -> np.ndarray:
        """The mean over the six sectors and their mirror images."""
        along = (shift * out).sum(axis=1)
        across = shift[:, 1] * out[:, 0] - shift[:, 0] * out[:, 1]
        along[0] = across[0] = 0.0
        for k in range(1, number + 1):
            of_ring = slice(3 * k * (k - 1) + 1, 3 * k * (k + 1) + 1)
            for part, sign in ((along, 1), (across, -1)):
                mean = part[of_ring].reshape(6, k).mean(axis=0)
                part[of_ring] = np.tile(0.5 * (mean + sign * np.roll(mean[::-1], 1)), 6)
        return along[:, None] * out + across[:, None] * np.stack([-out[:, 1], out[:, 0]], axis=1)

    rings = step / spacing * ring[:, None] * out
    return spacing * balanced(rings, ring < number - 1, symmetrised)


def _ring_radii(outermost: float, dp: float) -> np.ndarray:
    """Radii from the centre or dp/2 on, whichever lets them lie more nearly dp apart."""
    steps = outermost / dp
    around_centre = abs(steps - round(steps)) <= abs(steps - 0.5 - round(steps - 0.5))
    inner = 0.0 if around_centre else 0.5
    number = max(round(steps - inner), 0)
    return outermost * (np.arange(number + 1) + inner) / (number + inner or 1.0)


def _directions(number: float, dim: int, between: bool) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (n, dim), about so many, and their shares (n,) of all directions.

    Up to one: the zero vector.  `between` turns a ring by half a step.
    """
    if number <= 1:
        return np.zeros((1, dim)), np.ones(1)
    return _ring(number, between) if dim == 2 else _shell(number)


def _ring(number: float, between: bool) -> tuple[np.ndarray, np.ndarray]:
    """A multiple of four, so that the axes and their diagonals are mirrors."""
    n = 4 * max(1, round(number / 4))
    angle = 2 * np.pi * (np.arange(n) + 0.5 * between) / n
    return np.stack([np.cos(angle), np.sin(angle)], axis=1), alike(n)


@lru_cache(maxsize=16)
def _shell(number: float) -> tuple[np.ndarray, np.ndarray]:
    """The 4 k^2 + 2 points of an octahedron whose edges are cut into k parts, on the sphere.

    The sine spreads them nearly evenly; shares are areas of Voronoi cells, 0.8 to 1.4 of the mean.
    """
    from scipy.spatial import SphericalVoronoi

    k = max(1, round(np.sqrt(max(number - 2, 0) / 4)))
    octant = np.array([(i, j, k - i - j) for i in range(k + 1) for j in range(k + 1 - i)])
    steps = np.unique(np.concatenate([octant * s for s in product((1, -1), repeat=3)]), axis=0)
    unit = np.sin(0.5 * np.pi * steps / k)
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    area = SphericalVoronoi(unit).calculate_areas()
    return unit, area / area.sum()
