"""Particles that start almost on top of one another."""

from __future__ import annotations

from itertools import product

import numpy as np

from .particles import ParticleSet

TOO_NEAR = 0.3  # of the smaller particle's spacing
CANDIDATES = 8  # looked at in each cell: enough to notice any overlap, and bounded in a heap
HASH = np.array([73856093, 19349663, 83492791], dtype=np.int64)  # linear, so neighbours add up


def describe_overlaps(particles: ParticleSet, names: list[str]) -> list[str]:
    """One sentence for each pair of bodies (or body with itself) that has overlapping particles."""
    sentences = []
    for (first, second), count in _overlapping_bodies(particles).items():
        other = "itself" if first == second else names[second]
        sentences.append(
            f"{names[first]} overlaps {other}: pairs of particles ({count} or more) are "
            f"nearer than {TOO_NEAR} of their spacing"
        )
    return sentences


def _overlapping_bodies(particles: ParticleSet) -> dict[tuple[int, int], int]:
    i, j = _near_pairs(particles)
    if len(i) == 0:
        return {}
    bodies = np.sort(np.column_stack([particles.body[i], particles.body[j]]), axis=1)
    kinds, counts = np.unique(bodies, axis=0, return_counts=True)
    return {(int(a), int(b)): int(n) for (a, b), n in zip(kinds, counts, strict=True)}


def _near_pairs(particles: ParticleSet) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i, j nearer than TOO_NEAR of the smaller spacing, found through cells of that size."""
    dim = particles.dim
    spacing = (particles.mass / particles.density) ** (1 / dim)
    with np.errstate(invalid="ignore"):
        cells = np.floor(particles.position / (TOO_NEAR * spacing.max(initial=0.0)))
        keys = cells.astype(np.int64) @ HASH[:dim]
    order = np.argsort(keys, kind="stable")
    i, j = _candidates(keys[order], dim)
    i, j = order[i], order[j]
    gap = np.linalg.norm(particles.position[i] - particles.position[j], axis=1)
    near = gap < TOO_NEAR * np.minimum(spacing[i], spacing[j])
    return i[near], j[near]


def _candidates(keys: np.ndarray, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of indices into the sorted `keys` whose cells are the same or neighbours."""
    index = np.arange(len(keys))
    pairs = []
    for offset in product((-1, 0, 1), repeat=dim):
        if offset < (0,) * dim:
            continue  # the opposite offset finds these pairs
        wanted = keys + np.array(offset) @ HASH[:dim]
        first = np.searchsorted(keys, wanted) if any(offset) else index + 1
        end = np.searchsorted(keys, wanted, side="right")
        for step in range(CANDIDATES):
            found = first + step < end
            if not found.any():
                break
            pairs.append((index[found], (first + step)[found]))
    none = np.zeros(0, dtype=np.int64)
    return (
        np.concatenate([none, *(i for i, _ in pairs)]),
        np.concatenate([none, *(j for _, j in pairs)]),
    )
