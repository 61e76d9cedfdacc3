"""Faces of walls and bodies between which water stands where no particle fits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..compiled import load_core
from ..record.particles import FIXED, ParticleSet
from ..scenario.model import Scenario
from .bodies import Bodies
from .periodic import nearest_image, periods

NO_FACE, FIXED_FACE, FIRST_BODY = 0, 1, 2  # numbers of the core's faces
NEXT_ROW = 0.9  # spacings from where a row would go on to one that is there, on any lattice


class ContactFaces(NamedTuple):
    """Of each particle: which face it belongs to, and how large its part of it is."""

    # (N,) int32: none, that of all fixed bodies, or FIRST_BODY + index of a body, rigid ones first;
    # with a minus below its first row
    face: np.ndarray
    area: np.ndarray  # (N, dim) outwards, m2 (2-D: m): what its own body leaves of its kernel


def contact_faces(
    scenario: Scenario,
    particles: ParticleSet,
    bodies: Bodies,
    depth: np.ndarray,
    normal: np.ndarray,
) -> ContactFaces:
    """The faces of all bodies and fixed walls: their first row, less than dp deep.

    Of bodies that move the row below as well: the kernel reaches from there to another face.
    `depth` (N,) below the surface, m, whose `normal` (N, dim) points outwards.
    """
    n = len(particles)
    face, area = np.full(n, NO_FACE, np.int32), np.zeros((n, scenario.dim))
    first_row = depth < scenario.dp
    fixed = np.flatnonzero(first_row & (particles.motion == FIXED))
    surface = particles.position[fixed] + depth[fixed, None] * normal[fixed]
    face[fixed[~_is_covered(scenario, particles, surface, normal[fixed])]] = FIXED_FACE
    body, place = _body_of_each(bodies), _at_rest(particles, bodies)
    of_body = (depth < 2 * scenario.dp) & (body >= 0)
    number = FIRST_BODY + body[of_body]
    face[of_body] = np.where(first_row[of_body], number, -number)
    volume = particles.mass / particles.density
    for members, offset in _members(scenario, place, body):
        area[members] = _Pairs.of(offset, scenario).areas(volume[members])
    return ContactFaces(face, area)


def _is_covered(
    scenario: Scenario, particles: ParticleSet, surface: np.ndarray, normal: np.ndarray
) -> np.ndarray:
    """Mask (n,) of places on a wall that another one stands on: neither water nor air is there."""
    from scipy.spatial import cKDTree

    walls = particles.position[particles.motion == FIXED]
    if not len(surface):
        return np.zeros(0, bool)
    gap, nearest = cKDTree(walls).query(surface + 0.5 * scenario.dp * normal)
    above = ((walls[nearest] - surface) * normal).sum(axis=1) > 0.0
    return above & (gap < NEXT_ROW * scenario.dp)


def _body_of_each(bodies: Bodies) -> np.ndarray:
    """Index (N,) of the body of each particle, of rigid ones and then of deformable ones, or -1."""
    body = bodies.grain.copy()
    deformable = [elastic for elastic in bodies.elastic if not elastic.rigid_first]
    for k, elastic in enumerate(deformable):
        body[elastic.members] = len(bodies) + k
    return body


def _at_rest(particles: ParticleSet, bodies: Bodies) -> np.ndarray:
    """Positions (N, dim), those of bodies that deform where these have no stress, m."""
    place = particles.position.copy()
    for elastic in bodies.elastic:
        if not elastic.rigid_first:
            place[elastic.members] = elastic.rest
    return place


def _members(
    scenario: Scenario, place: np.ndarray, body: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Of each body: indices of its particles, and their places about the first of them, m."""
    bound = np.flatnonzero(body >= 0)
    order = bound[np.argsort(body[bound], kind="stable")]
    ends = np.flatnonzero(np.diff(body[order])) + 1
    period = periods(scenario)
    for members in np.split(order, ends) if len(order) else []:
        apart = place[members] - place[members[0]]
        yield members, nearest_image(apart, period)


class _Pairs(NamedTuple):
    """Pairs of particles of one body: indices, the vector from i to j, and F of the kernel."""

    particles: int
    i: np.ndarray
    j: np.ndarray
    apart: np.ndarray  # (n, dim), m
    factor: np.ndarray

    @classmethod
    def of(cls, position: np.ndarray, scenario: Scenario) -> _Pairs:
        """All that the kernel reaches."""
        from scipy.spatial import cKDTree

        i, j = cKDTree(position).query_pairs(scenario.support, output_type="ndarray").T
        apart = position[j] - position[i]
        factor = _gradient_factor(scenario, np.linalg.norm(apart, axis=1))
        return cls(len(position), i, j, apart, factor)

    def areas(self, volume: np.ndarray) -> np.ndarray:
        """Area vectors (particles, dim): -2 V_i sum V F r over what is not the body.

        A kernel that is full has none, so that this is the opposite of the sum over the body
        itself; those of a whole body add up to nothing.
        """
        share = (2 * volume[self.i] * volume[self.j] * self.factor)[:, None] * self.apart
        area = np.zeros((self.particles, self.apart.shape[1]))
        np.add.at(area, self.i, share)
        np.add.at(area, self.j, -share)
        return area


def _gradient_factor(scenario: Scenario, r: np.ndarray) -> np.ndarray:
    """F of the scheme's kernel at distances r, m, scaled by its moment on a lattice (eq. 25)."""
    dp, dim = scenario.dp, scenario.dim
    reach = int(scenario.support / dp) + 1
    axes = [dp * np.arange(-reach, reach + 1.0)] * dim
    lattice = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, dim)
    around = _plain_factor(scenario, np.linalg.norm(lattice, axis=1))
    return _plain_factor(scenario, r) / (-(dp**dim) * float(around @ lattice[:, 0] ** 2))


def _plain_factor(scenario: Scenario, r: np.ndarray) -> np.ndarray:
    physics = getattr(load_core().physics, "two" if scenario.dim == 2 else "three")
    kernel = physics.kernel if scenario.kernel == "wendland_c6" else physics.wendland_c2
    _, factor = kernel([r.tolist(), [1 / scenario.support] * len(r)])
    return np.asarray(factor)
