#!/usr/bin/env python3
"""Two equal elastic discs meet head-on: finite elements, and a contact without a stiffness.

.venv/bin/python validation/references/elastic_discs.py [RINGS ...]

By symmetry the impact is that of half a disc, cut along the line of centres, on a frictionless
mirror.  Linear triangles in plane strain, finite strain, St Venant-Kirchhoff's law, lumped mass and
central differences; a node that would pass the mirror is stopped at it, which is the Lagrange
multiplier of Carpenter, Taylor and Katona (Int. J. Numer. Meth. Eng. 32, 1991): nothing penetrates
and there is no penalty to choose.  Step and elements are refined together.  Prints the rows of
python/doseki/validate/data/elastic-discs.csv, some twenty minutes with 50, 100 and 200 rings.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.sparse import csr_array

RADIUS, DENSITY, YOUNG, POISSON = 0.05, 1000.0, 1e7, 0.3
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
MU = YOUNG / (2 * (1 + POISSON))
WAVE = np.sqrt((LAMBDA + 2 * MU) / DENSITY)
SPEEDS = (0.5, 1.0, 2.0)  # of approach, m/s
RINGS = (50, 100, 200)
FOCI = (0.4, 0.6)  # two families of meshes, see half_disc
COURANT = 0.7
END = 6e-3  # s, some 1.5 times of contact
WINDOW = 5e-5  # s, over which the force is averaged

Tensor = tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def half_disc(rings: int, focus: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (N, 2) and triangles (M, 3) of y >= 0, the mirror being x = 0.

    Rings of 3 k elements, then the conformal map of the disc on itself that makes elements at the
    mirror (1 - focus)/(1 + focus) times as large.
    """
    angles = [np.linspace(0, np.pi, 3 * k + 1) for k in range(rings + 1)]
    first = np.cumsum([0] + [len(ring) for ring in angles])
    triangles = []
    for k in range(1, rings + 1):
        for sector in range(3):
            inner, outer = first[k - 1] + sector * (k - 1), first[k] + sector * k
            for j in range(k):
                triangles.append((outer + j, outer + j + 1, inner + j))
                if j < k - 1:
                    triangles.append((outer + j + 1, inner + j + 1, inner + j))
    z = np.concatenate([k / rings * np.exp(1j * ring) for k, ring in enumerate(angles)])
    z = (z + focus) / (1 + focus * z) - 1
    return RADIUS * np.column_stack([z.real, z.imag]), np.array(triangles)


def second_piola(F: Tensor) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """S_xx, S_yy, S_xy and the energy per area at rest, in plane strain."""
    (a, b), (c, d) = F
    xx, yy, xy = (a * a + c * c - 1) / 2, (b * b + d * d - 1) / 2, (a * b + c * d) / 2
    pressure = LAMBDA * (xx + yy)
    energy = pressure * (xx + yy) / 2 + MU * (xx * xx + yy * yy + 2 * xy * xy)
    return pressure + 2 * MU * xx, pressure + 2 * MU * yy, 2 * MU * xy, energy


class Solid:
    """Linear triangles: gradients, areas and masses at rest; forces of places."""

    def __init__(self, nodes: np.ndarray, triangles: np.ndarray) -> None:
        corner = nodes[triangles]
        edge = np.roll(corner, 1, axis=1) - np.roll(corner, -1, axis=1)  # opposite to each corner
        twice = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
        self.area = twice / 2
        self.mass = DENSITY * np.bincount(triangles.ravel(), np.repeat(self.area / 3, 3))
        self.height = float((twice / np.linalg.norm(edge, axis=2).max(axis=1)).min())
        rows, shape = np.repeat(np.arange(len(triangles)), 3), (len(triangles), len(nodes))
        slopes = (-edge[..., 1] / twice[:, None], edge[..., 0] / twice[:, None])
        self.slopes = [csr_array((s.ravel(), (rows, triangles.ravel())), shape) for s in slopes]
        self.scatter = [matrix.T.tocsr() for matrix in self.slopes]

    def gradient(self, place: np.ndarray) -> Tensor:
        """The deformation gradient F of places (2, N)."""
        (a, b), (c, d) = ([matrix @ row for matrix in self.slopes] for row in place)
        return (a, b), (c, d)

    def energy(self, place: np.ndarray) -> float:
        """Elastic energy, J/m."""
        return float(self.area @ second_piola(self.gradient(place))[3])

    def force(self, place: np.ndarray) -> np.ndarray:
        """Force on the nodes (2, N), N/m: minus the gradient of the energy."""
        F = self.gradient(place)
        xx, yy, xy, _ = second_piola(F)
        rows = [(a * xx + b * xy, a * xy + b * yy) for a, b in F]
        pull = [[D @ (self.area * P) for D, P in zip(self.scatter, r, strict=True)] for r in rows]
        return -np.array([x + y for x, y in pull])


@dataclass(frozen=True)
class Impact:
    """What the mirror did to a whole disc: times (n,), force (n,) and what is left of the run."""

    times: np.ndarray
    force: np.ndarray
    restitution: float
    energy_gain: float  # relative

    @property
    def contact_time(self) -> float:
        """From the first force to the last, s."""
        touching = self.times[self.force > 0]
        return float(touching[-1] - touching[0])

    @property
    def greatest_force(self) -> float:
        """Of means over WINDOW, N/m."""
        count = max(1, round(WINDOW / (self.times[1] - self.times[0])))
        return float(np.convolve(self.force, np.ones(count) / count, "valid").max())


def impact(rings: int, focus: float, speed: float) -> Impact:
    """The half disc meets the mirror at half the speed of approach."""
    nodes, triangles = half_disc(rings, focus)
    solid, place = Solid(nodes, triangles), nodes.T.copy()
    held = place[1] < 1e-9 * RADIUS  # the line of centres
    velocity = np.zeros_like(place)
    velocity[0] = speed / 2
    dt = COURANT * solid.height / WAVE
    before, force = _energy(solid, place, velocity), []
    for _ in range(round(END / dt)):
        velocity += dt * solid.force(place) / solid.mass
        velocity[1, held] = 0
        stopped = np.maximum(place[0] / dt + velocity[0], 0)
        velocity[0] -= stopped
        place += dt * velocity
        force.append(2 * solid.mass @ stopped / dt)
    after = _energy(solid, place, velocity - dt / 2 * solid.force(place) / solid.mass)
    return Impact(
        dt * np.arange(len(force)),
        np.array(force),
        float(-(solid.mass @ velocity[0]) / (solid.mass.sum() * speed / 2)),
        after / before - 1,
    )


def _energy(solid: Solid, place: np.ndarray, velocity: np.ndarray) -> float:
    return solid.energy(place) + float(solid.mass @ (velocity**2).sum(axis=0)) / 2


def extrapolated(sizes: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """The limit of values by a straight line over the size of elements, and how far it may be off.

    That is its distance from the finest value and the largest distance of a value from the line.
    """
    size = np.array(sizes)
    slope, limit = np.polyfit(size, values, 1)
    rest = np.abs(limit + slope * size - values).max()
    return float(limit), float(abs(limit - values[np.argmin(size)]) + rest)


def row_of(speed: float, rings: Sequence[int]) -> list[float]:
    """The limits at a speed of approach, each with its doubt; prints the runs."""
    sizes, table = [], []
    for focus, count in product(FOCI, rings):
        run = impact(count, focus, speed)
        sizes.append(RADIUS / count * (1 - focus) / (1 + focus))
        table.append((run.restitution, run.contact_time, run.greatest_force))
        said = f"{run.restitution:.5f}, {run.contact_time:.5g} s, {run.greatest_force:.5g} N/m"
        print(f"# {speed} m/s, {focus}, {count}: {said}, energy {run.energy_gain:+.1e}", flush=True)
    limits = [extrapolated(sizes, column) for column in zip(*table, strict=True)]
    return [speed, *(number for limit in limits for number in limit)]


def main() -> None:
    """Print the runs and the rows of the table."""
    rings = [int(word) for word in sys.argv[1:]] or RINGS
    for speed in SPEEDS:
        print(",".join(f"{number:.5g}" for number in row_of(speed, rings)), flush=True)


if __name__ == "__main__":
    main()
