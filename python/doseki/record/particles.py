"""Particles as arrays: the state handed from the scenario to the solver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ..errors import ResourceError
from ..util.memory import available_bytes

MAX_PARTICLES = 2_000_000_000
BYTES_PER_PARTICLE = 500  # what a run holds, lists included
FREE, FIXED, DRIVEN, BOUND = 0, 1, 2, 3


@dataclass
class ParticleSet:
    """N particles in `dim` dimensions, SI units, C-contiguous arrays.

    In 2-D a mass is per metre of thickness.  `material` and `body` are indices into the lists of
    names kept beside the set; `motion` is FREE, FIXED, DRIVEN (moved by an inflow) or BOUND (a
    point of a body that moves).
    """

    position: np.ndarray  # (N, dim) float64, m
    velocity: np.ndarray  # (N, dim) float64, m/s
    mass: np.ndarray  # (N,) float64, kg (2-D: kg/m)
    density: np.ndarray  # (N,) float64, kg/m3
    smoothing_length: np.ndarray  # (N,) float64, m
    material: np.ndarray  # (N,) int32
    body: np.ndarray  # (N,) int32
    motion: np.ndarray  # (N,) int32
    id: np.ndarray  # (N,) int64, unique

    def __len__(self) -> int:
        return len(self.mass)

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return self.position.shape[1]

    def chosen(self, keep: np.ndarray) -> ParticleSet:
        """Those of a mask (N,), or of indices."""
        return ParticleSet(**{name: values[keep] for name, values in vars(self).items()})

    @classmethod
    def empty(cls, dim: int) -> ParticleSet:
        """No particle at all, with the right shapes and types."""
        return cls(
            position=np.zeros((0, dim)),
            velocity=np.zeros((0, dim)),
            mass=np.zeros(0),
            density=np.zeros(0),
            smoothing_length=np.zeros(0),
            material=np.zeros(0, np.int32),
            body=np.zeros(0, np.int32),
            motion=np.zeros(0, np.int32),
            id=np.zeros(0, np.int64),
        )


def concatenate(parts: Sequence[ParticleSet], dim: int) -> ParticleSet:
    """Join particle sets in order and number the particles 0, 1, 2, ... anew."""
    parts = [ParticleSet.empty(dim), *parts]
    joined = {
        field.name: np.ascontiguousarray(np.concatenate([getattr(p, field.name) for p in parts]))
        for field in fields(ParticleSet)
    }
    joined["id"] = np.arange(len(joined["mass"]), dtype=np.int64)
    return ParticleSet(**joined)


def check_size(counts: Mapping[str, float]) -> None:
    """Refuse what cannot be held, before anything is allocated.

    Args:
        counts: particles of each table, such as "body.water".

    Raises:
        ResourceError: they are too many for this program, or for the memory of this machine.

    """
    total, free = sum(counts.values()), available_bytes()
    if total > MAX_PARTICLES or total * BYTES_PER_PARTICLE > free:
        largest = max(counts, key=lambda name: counts[name])
        raise ResourceError(
            f"the scenario asks for {total:.3g} particles ({counts[largest]:.3g} of them in "
            f"{largest}), about {total * BYTES_PER_PARTICLE / 2**30:.3g} GiB; at most "
            f"{min(MAX_PARTICLES, free / BYTES_PER_PARTICLE):.3g} fit: increase dp"
        )
