"""Elastic bodies by themselves."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from doseki.scenario.materials import ELASTIC_DEFAULTS

RUBBER = {"rho0": 1000.0, "young_modulus": 1e6, "poisson_ratio": 0.3}


@pytest.fixture
def elastic(core: ModuleType) -> Callable[..., Any]:
    """Makes started bodies of rubber, each (position, velocity) with or without `clamped`.

    They start at rest places, or by `displacement` (N, dim) from there.
    """

    def make(
        *bodies: tuple[np.ndarray, ...], spacing: float, displacement: Any = 0.0, **material: Any
    ) -> Any:
        dim = bodies[0][0].shape[1]
        made = getattr(core, f"ElasticBodies{dim}")()
        for position, velocity, *rest in bodies:
            clamped = rest[0] if rest else np.zeros(len(position), bool)
            made.add(
                ELASTIC_DEFAULTS | RUBBER | {"spacing": spacing} | material,
                rest=np.ascontiguousarray(position - displacement),
                position=np.ascontiguousarray(position),
                velocity=np.ascontiguousarray(velocity),
                clamped=clamped.astype(np.uint8),
            )
        made.start()
        return made

    return make


def lattice(counts: tuple[int, ...], spacing: float) -> np.ndarray:
    """Points of a box, centred on the origin."""
    axes = [(np.arange(n) + 0.5 - n / 2) * spacing for n in counts]
    return np.stack([x.ravel() for x in np.meshgrid(*axes, indexing="ij")], axis=1)


def energy(state: dict[str, Any]) -> float:
    """Of motion and strain."""
    return state["kinetic_energy"] + state["strain_energy"]
