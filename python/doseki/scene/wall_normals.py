"""Walls for the resolved scheme: a normal into the fluid and a depth for each particle."""

from __future__ import annotations

import numpy as np

from ..record.particles import FIXED, ParticleSet
from ..scenario.model import Scenario
from .kinds.registry import bodies_of


def wall_geometry(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Normals (N, dim) into the fluid and depths (N,) below it, m.

    Zero where not fixed, and for the fixed bodies whose particles bring their own.  `names` are
    those that the field `body` of `particles` indexes.  Raises UserError for walls that do not say
    where the fluid is.
    """
    normal, depth = np.zeros_like(particles.position), np.zeros(len(particles))
    for name, body in bodies_of(scenario).items():
        own = [names.index(each) for each in scenario.names_of_bodies(name)]
        of_it = (particles.motion == FIXED) & np.isin(particles.body, own)
        if of_it.any() and not body.table.is_solid:
            normal[of_it], depth[of_it] = body.wall(particles.position[of_it], particles)
    return normal, depth
