"""Walls for the resolved scheme: a normal into the fluid and a depth for each particle."""

from __future__ import annotations

import numpy as np

from ..record.particles import FIXED, ParticleSet, concatenate
from ..scenario.model import Scenario
from .build import particles_at_zero
from .kinds.registry import bodies_of
from .moved import Displacement
from .shapes import Edges, no_edges


def wall_geometry(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> tuple[np.ndarray, np.ndarray, Edges]:
    """Normals (N, dim) into the fluid, depths (N,) below it, m, and the faces beside edges.

    Zero where not fixed, and for the fixed bodies whose particles bring their own.  `names` are
    those that the field `body` of `particles` indexes.  Raises UserError for walls that do not say
    where the fluid is.
    """
    normal, depth = np.zeros_like(particles.position), np.zeros(len(particles))
    edges = no_edges(len(particles), scenario.dim)
    made = _Made(scenario, particles, names)
    for name, body in bodies_of(scenario).items():
        own = [names.index(each) for each in scenario.names_of_bodies(name)]
        of_it = (particles.motion == FIXED) & np.isin(particles.body, own)
        if body.is_of_bodies or not of_it.any():
            continue
        place = made.position(name, of_it), made.around(name)
        facing, below = body.wall(*place)
        normal[of_it] = made.turned(name, facing)
        depth[of_it] = below
        beside = body.edges(*place)
        turned = made.turned(name, beside.normals.reshape(-1, scenario.dim))
        edges.normals[of_it] = turned.reshape(beside.normals.shape)
        edges.depths[of_it] = beside.depths
    return normal, depth, edges


class _Made:
    """The scene in which walls were made: of a run that goes on from another, that at time zero."""

    def __init__(self, scenario: Scenario, particles: ParticleSet, names: list[str]) -> None:
        self._scenario, self._particles = scenario, particles
        self._at_zero: dict[str, ParticleSet] = {}
        if scenario.earlier is not None:
            self._at_zero = particles_at_zero(scenario, names)
        there = [part for name, part in self._at_zero.items() if name in scenario.carried]
        self._there = concatenate(there, scenario.dim)

    def position(self, name: str, of_it: np.ndarray) -> np.ndarray:
        """Of the fixed particles of a body, which are those where `of_it`."""
        if name not in self._at_zero:
            return self._particles.position[of_it]
        part = self._at_zero[name]
        return part.position[part.motion == FIXED]

    def around(self, name: str) -> ParticleSet:
        """All particles among which the body was put."""
        return self._there if name in self._scenario.carried else self._particles

    def turned(self, name: str, normal: np.ndarray) -> np.ndarray:
        """Normals as the body has turned since."""
        return Displacement(self._scenario, name).vectors(normal) if self._at_zero else normal
