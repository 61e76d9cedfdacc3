"""Meshes that go into other walls, as a dam does into its banks: particles of both in one place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from ...record.particles import FIXED, ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.mesh import Mesh

TOO_NEAR = 0.5  # of the mesh's spacing; where lattices cross, 0.7 would leave holes


def without_common(
    scenario: Scenario, built: Mapping[str, ParticleSet], spacing: Mapping[str, float]
) -> dict[str, ParticleSet]:
    """What is built of each body, without what of a mesh lies in other walls at rest.

    Of two meshes the first in the scenario stays whole.  `spacing`, m, by body.
    """
    still = {name for name in built if scenario.body[name].prescribed_motion is None}
    meshes = [name for name in built if isinstance(scenario.body[name], Mesh) and name in still]
    if not meshes:
        return dict(built)
    others = [_fixed(built[name]) for name in built if name in still and name not in meshes]
    result = dict(built)
    for name in meshes:
        there = np.concatenate([np.zeros((0, 3)), *others])
        if len(there):
            reach = TOO_NEAR * spacing[name]
            own = result[name]
            apart = cKDTree(there).query(own.position, distance_upper_bound=reach)[0]
            result[name] = _kept(own, np.isinf(apart))
        others.append(result[name].position)
    return result


def _fixed(particles: ParticleSet) -> np.ndarray:
    return particles.position[particles.motion == FIXED]


def _kept(particles: ParticleSet, keep: np.ndarray) -> ParticleSet:
    if keep.all():
        return particles
    columns: dict[str, Any] = {key: values[keep] for key, values in vars(particles).items()}
    return replace(particles, **columns | {"id": np.arange(int(keep.sum()), dtype=np.int64)})
