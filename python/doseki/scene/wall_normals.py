"""Walls for the resolved scheme: a normal into the fluid and a depth for each particle."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..record.particles import FIXED, ParticleSet, concatenate
from ..scenario.model import Scenario
from .build import particles_at_zero
from .kinds.body import Body
from .kinds.registry import bodies_of
from .moved import Displacement
from .shapes import Edges, no_edges


def wall_geometry(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Normals (N, dim) into the fluid and depths (N,) below it, m.

    Zero where not fixed, and for the fixed bodies whose particles bring their own.  `names` are
    those that the field `body` of `particles` indexes.  Raises UserError for walls that do not say
    where the fluid is.
    """
    normal, depth = np.zeros_like(particles.position), np.zeros(len(particles))
    made = _Made(scenario, particles, names)
    for name, body, of_it in _fixed_bodies(scenario, particles, names):
        if body.is_of_bodies:
            continue
        facing, below = body.wall(made.position(name, of_it), made.around(name))
        normal[of_it] = made.turned(name, facing)
        depth[of_it] = below
    return normal, depth


def wall_edges(scenario: Scenario, particles: ParticleSet, names: list[str]) -> Edges:
    """The faces nearest to each particle of fixed bodies beside their edges, else zero."""
    edges = no_edges(len(particles), scenario.dim)
    made = _Made(scenario, particles, names)
    for name, body, of_it in _fixed_bodies(scenario, particles, names):
        own = body.edges(made.position(name, of_it), made.around(name))
        turned = made.turned(name, own.normals.reshape(-1, scenario.dim))
        edges.normals[of_it] = turned.reshape(own.normals.shape)
        edges.depths[of_it] = own.depths
    return edges


def _fixed_bodies(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> Iterator[tuple[str, Body[Any], np.ndarray]]:
    """Fixed bodies, and which particles are theirs."""
    for name, body in bodies_of(scenario).items():
        own = [names.index(each) for each in scenario.names_of_bodies(name)]
        of_it = (particles.motion == FIXED) & np.isin(particles.body, own)
        if of_it.any():
            yield name, body, of_it


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
