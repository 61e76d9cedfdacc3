"""Particles that start almost on top of one another."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

import numpy as np

from ...record.particles import FIXED, ParticleSet
from ...util.finding import Finding

TOO_NEAR = 0.3  # of the smaller particle's spacing
NEAREST = 9  # looked at of each particle, itself included: bounded also where many coincide


@dataclass(frozen=True)
class Overlap(Finding):
    """Two bodies, or one body with itself, that have overlapping particles."""

    other: str
    pairs: int  # or more

    def __str__(self) -> str:
        other = "itself" if self.other == self.place else self.other
        return (
            f"{self.place} overlaps {other}: pairs of particles ({self.pairs} or more) are "
            f"nearer than {TOO_NEAR} of their spacing"
        )


def find_overlaps(
    particles: ParticleSet,
    names: list[str],
    known: Set[str] = frozenset(),
    clamped: np.ndarray | None = None,
) -> list[Overlap]:
    """One for each pair of bodies (or body with itself) that has overlapping particles.

    Among those `known` nothing is looked for: they have moved already.  Particles that are
    `clamped` (N,) may lie in fixed ones, which hold them.
    """
    found = _overlapping_bodies(particles, clamped).items()
    pairs = [(names[first], names[second], count) for (first, second), count in found]
    return [Overlap(a, b, count) for a, b, count in pairs if not known >= {a, b}]


def _overlapping_bodies(
    particles: ParticleSet, clamped: np.ndarray | None
) -> dict[tuple[int, int], int]:
    i, j = _near_pairs(particles)
    if clamped is not None:
        fixed = particles.motion == FIXED
        held = (clamped[i] & fixed[j]) | (fixed[i] & clamped[j])
        i, j = i[~held], j[~held]
    if len(i) == 0:
        return {}
    bodies = np.sort(np.column_stack([particles.body[i], particles.body[j]]), axis=1)
    kinds, counts = np.unique(bodies, axis=0, return_counts=True)
    return {(int(a), int(b)): int(n) for (a, b), n in zip(kinds, counts, strict=True)}


def _near_pairs(particles: ParticleSet) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i < j nearer than TOO_NEAR of the smaller spacing, among the nearest of each."""
    from scipy.spatial import cKDTree

    spacing = (particles.mass / particles.density) ** (1 / particles.dim)
    tree = cKDTree(particles.position)
    distance, other = tree.query(
        particles.position, NEAREST, distance_upper_bound=TOO_NEAR * spacing.max(initial=0.0)
    )
    index = np.repeat(np.arange(len(spacing)), NEAREST)
    distance, other = distance.ravel(), other.ravel()
    found = np.isfinite(distance) & (index != other)
    i, j, distance = index[found], other[found], distance[found]
    near = distance < TOO_NEAR * np.minimum(spacing[i], spacing[j])
    pairs = np.unique(np.sort(np.stack([i[near], j[near]], axis=1), axis=1), axis=0)
    return pairs[:, 0], pairs[:, 1]
