"""The density at which a fixed bed carries a flow without a gap."""

from __future__ import annotations

import numpy as np

from ..compiled import load_core


def covered_share(depth: np.ndarray, spacing: float, support: float, dim: int) -> np.ndarray:
    """The share of a particle's kernel sum that lies above a surface `depth` over it.

    `depth` (N,), m.  Above the surface a lattice of the given spacing continues the particle's own,
    its first row half a spacing above the surface.
    """
    unique, index = np.unique(np.round(depth / spacing, 9), return_inverse=True)
    return np.array([_sum_above(d, spacing, support, dim) for d in unique])[index]


def _sum_above(depth: float, spacing: float, support: float, dim: int) -> float:
    """Sum of W dp^dim over the lattice above a particle; `depth` in spacings."""
    rim = int(np.ceil(support / spacing))
    lateral = np.arange(-rim, rim + 1.0)
    axes = [lateral] * (dim - 1) + [depth + 0.5 + np.arange(rim)]
    r = spacing * np.sqrt(sum(axis**2 for axis in np.meshgrid(*axes))).ravel()
    physics = getattr(load_core().physics, "two" if dim == 2 else "three")
    weight, _ = physics.kernel([list(r), [1.0 / support] * len(r)])
    return float(np.sum(weight)) * spacing**dim
