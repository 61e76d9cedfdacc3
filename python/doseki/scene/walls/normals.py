"""Walls for the resolved scheme: a normal into the fluid and a depth for each particle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from ...record.particles import FIXED, ParticleSet, concatenate
from ...scenario.model import Scenario
from ..bodies import Bodies
from ..build import particles_at_zero
from ..kinds.body import Body
from ..kinds.registry import bodies_of
from ..moved import Displacement
from ..shapes import EDGE, Edges, beside_edges, nearest_faces, no_edges
from ..unions.covering import Covering


class WallGeometry(NamedTuple):
    """Of N particles; zero where they are of no wall or body."""

    normal: np.ndarray  # (N, dim) into the fluid
    depth: np.ndarray  # (N,) below the surface, m
    edges: Edges

    def put(self, rows: np.ndarray, normal: np.ndarray, depth: np.ndarray, edges: Edges) -> None:
        """Those of some particles."""
        self.normal[rows], self.depth[rows] = normal, depth
        self.edges.normals[rows], self.edges.depths[rows] = edges


def wall_geometry(
    scenario: Scenario, particles: ParticleSet, names: list[str], shaped: Bodies | None = None
) -> WallGeometry:
    """Where the surface of fixed bodies is, and of those of which `shaped` has particles.

    Zero for the others.  `names` are those that the field `body` of `particles` indexes.  Raises
    UserError for walls that do not say where the fluid is.
    """
    n, dim = particles.position.shape
    walls = WallGeometry(np.zeros((n, dim)), np.zeros(n), no_edges(n, dim))
    bodies, made = bodies_of(scenario), _Made(scenario, particles, names)
    parts = dict(_fixed_parts(scenario, bodies, particles, names))
    for name, of_it in parts.items():
        body, place = bodies[name], (made.position(name, of_it), made.around(name))
        if not body.is_of_bodies:
            found = body.wall(*place)
            walls.put(of_it, *made.turned(name, *found, body.edges(*place)))
    if shaped is not None:
        own, edges = shaped.shaped, Edges(shaped.edge_normals, shaped.edge_depths)
        walls.put(own, shaped.normal[own], shaped.depth[own], Edges(*(e[own] for e in edges)))
    covering = Covering(
        scenario, bodies, {name: made.position(name, of_it) for name, of_it in parts.items()}
    )
    for name, of_it in parts.items():
        if shaped is not None or not bodies[name].is_of_bodies:
            _leave_out_covered(walls, scenario, bodies[name], of_it, covering, made)
    return walls


def _fixed_parts(
    scenario: Scenario, bodies: Mapping[str, Body[Any]], particles: ParticleSet, names: list[str]
) -> Iterator[tuple[str, np.ndarray]]:
    """The fixed bodies that have particles, and the mask (N,) of these."""
    for name in bodies:
        own = [names.index(each) for each in scenario.names_of_bodies(name)]
        of_it = (particles.motion == FIXED) & np.isin(particles.body, own)
        if of_it.any():
            yield name, of_it


def _leave_out_covered(
    walls: WallGeometry,
    scenario: Scenario,
    body: Body[Any],
    of_it: np.ndarray,
    covering: Covering,
    made: _Made,
) -> None:
    """Give the particles of a body that are near covered faces the others alone.

    Below a slanted side of what lies on them they have that side.
    """
    faces = body.plane_faces()
    if faces is None:
        return
    gaps = covering.gaps(body.name, faces, made.around(body.name))
    changed = np.isinf(gaps).any(axis=1)
    if changed.any():
        given = gaps[changed], faces.normals, EDGE * scenario.dp
        rows = np.flatnonzero(of_it)[changed]
        walls.put(rows, *made.turned(body.name, *nearest_faces(*given), beside_edges(*given)))
    for slant in covering.slants(body.name):
        near = slant.below < scenario.support + 0.5 * scenario.dp
        rows, n = np.flatnonzero(of_it)[slant.rows[near]], int(near.sum())
        surface = np.tile(slant.normal, (n, 1)), slant.below[near], no_edges(n, scenario.dim)
        walls.put(rows, *made.turned(body.name, *surface))


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
        still = self._scenario.body[name].prescribed_motion is None
        if name not in self._at_zero or still:
            return self._particles.position[of_it]
        part = self._at_zero[name]
        return part.position[part.motion == FIXED]

    def around(self, name: str) -> ParticleSet:
        """All particles among which the body was put."""
        return self._there if name in self._scenario.carried else self._particles

    def turned(
        self, name: str, normal: np.ndarray, depth: np.ndarray, edges: Edges
    ) -> tuple[np.ndarray, np.ndarray, Edges]:
        """The surface as the body has turned since."""
        if not self._at_zero:
            return normal, depth, edges
        turn = Displacement(self._scenario, name).vectors
        beside = turn(edges.normals.reshape(-1, self._scenario.dim)).reshape(edges.normals.shape)
        return turn(normal), depth, edges._replace(normals=beside)
