"""What is left out of a view, so that its file is no larger than it may be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

FEWEST_FRAMES = 40  # of a film that still moves smoothly; particles are thinned out then
FEWEST_AT_ALL = 12  # where one particle in ten would be left
SPARSE = 0.1
MANY_PARTICLES = 100_000  # of a frame: with more of them, those that no one sees are left out
MOST_PARTICLES = 600_000  # of a frame: more than a telephone draws
CELL = 1.2  # spacings: a particle is hidden where all cells around its own hold others
TRIES = 6


@dataclass(frozen=True)
class Thinning:
    """`frames` snapshots; all particles, or those of the `shell`, or a `share` of these."""

    frames: int
    shell: bool = False
    share: float = 1.0

    @property
    def swell(self) -> float:
        """By how much particles that are left are larger, so that the flow looks closed."""
        return min(3.0, self.share**-0.5)

    def kept(self, position: np.ndarray, spacing: float, ids: np.ndarray) -> np.ndarray:
        """Mask (n,) of the particles that are shown: by their ids, the same at all times."""
        mask = ~hidden(position, spacing) if self.shell else np.ones(len(ids), bool)
        if self.share < 1:
            mask &= _drawn_lot(ids) < self.share
        return mask


def _drawn_lot(ids: np.ndarray) -> np.ndarray:
    """A number from 0 to 1 for each id, as if at random (a multiplicative hash)."""
    mixed = ids.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    lot: np.ndarray = (mixed >> np.uint64(40)).astype(float) / 2**24
    return lot


def hidden(position: np.ndarray, spacing: float) -> np.ndarray:
    """Mask (n,) of particles that others surround on all sides, along each axis."""
    if not len(position):
        return np.zeros(0, bool)
    node = np.floor(position / (CELL * spacing)).astype(np.int64)
    node -= node.min(axis=0) - 1
    sizes = node.max(axis=0) + 2
    if float(np.prod(sizes.astype(float))) > 2**62:
        return np.zeros(len(position), bool)
    strides = np.concatenate([np.cumprod(sizes[::-1])[-2::-1], [1]])
    key = node @ strides
    there = np.unique(key)
    inside = np.ones(len(there), bool)
    for stride in strides:
        for side in (-stride, stride):
            inside &= np.isin(there + side, there, assume_unique=True)
    surrounded: np.ndarray = inside[np.searchsorted(there, key)]
    return surrounded


def thinned(
    all_frames: int, in_space: bool, most: float, cost: Callable[[Thinning], tuple[float, int]]
) -> Thinning:
    """What fits into `most` bytes.

    `cost` says how many bytes a frame takes, and how many particles it has at most. In space,
    particles that no one sees go first; then snapshots; then particles at random.
    """
    found = Thinning(all_frames)
    each, count = cost(found)
    if in_space and (each * found.frames > most or count > MANY_PARTICLES):
        found = replace(found, shell=True)
        each, count = cost(found)
    if each * found.frames > most:
        frames = max(min(FEWEST_FRAMES, all_frames), int(most / each))
        found = replace(found, frames=frames)
    for _ in range(TRIES):
        share = found.share * min(1.0, most / (each * found.frames), MOST_PARTICLES / max(1, count))
        if share >= found.share:
            break
        if share < SPARSE and found.frames > FEWEST_AT_ALL:
            fewer = max(FEWEST_AT_ALL, int(found.frames * share / SPARSE))
            share = min(found.share, share * found.frames / fewer)
            found = replace(found, frames=fewer)
        found = replace(found, share=0.97 * share)
        each, count = cost(found)
    return found


def spread(count: int, total: int) -> list[int]:
    """`count` of the indices 0 to `total` - 1, evenly, the first and the last among them."""
    return np.unique(np.rint(np.linspace(0, total - 1, count)).astype(int)).tolist()
