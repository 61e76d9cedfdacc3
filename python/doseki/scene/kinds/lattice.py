"""Bodies that can be turned, and those that are filled with particles on a lattice."""

from __future__ import annotations

from typing import Generic, TypeVar

import numpy as np

from ...scenario.tables.body import LatticeBody, TurnedBody
from ..groups import inside_bodies, quaternion_of
from ..lattices import rotated, rotation_matrix
from .shaped import Shaped

R = TypeVar("R", bound=TurnedBody)
L = TypeVar("L", bound=LatticeBody)
SHORTEST = 1e-100  # of an axis, of which the square is still a number


class Turned(Shaped[R], Generic[R]):
    """A body that can be rotated."""

    @property
    def axis(self) -> np.ndarray | None:
        """The unit vector (3,) that it is rotated about, where one is given."""
        axis = self.table.rotate_axis
        if axis is None:
            return None
        length = float(np.linalg.norm(axis))
        if self.dim == 2 or length < SHORTEST:
            raise self.error(
                f".rotate_axis = {axis.tolist()}: only a 3-D run has one, other than zero",
                "rotate_axis",
            )
        return np.asarray(axis / length)

    @property
    def orientation(self) -> np.ndarray:
        """The quaternion (4,) of its rotation."""
        return quaternion_of(self.table.rotate, self.dim, self.axis)

    @property
    def rotation(self) -> np.ndarray:
        """See Shaped."""
        axis = self.axis
        if self.table.rotate == 0:
            return np.eye(self.dim)
        return rotation_matrix(self.table.rotate, self.dim, axis)

    def turned(self, position: np.ndarray, pivot: np.ndarray) -> np.ndarray:
        """Positions (N, dim) as rotated about the given pivot, or about this one."""
        own = self.table.pivot
        return rotated(position, self.table.rotate, pivot if own is None else own, self.axis)


class Lattice(Turned[L], Generic[L]):
    """A body filled with particles on a lattice."""

    def lattice(self) -> tuple[np.ndarray, np.ndarray]:
        """Upright positions (N, dim), and the point about which they are turned by default."""
        raise NotImplementedError

    def mass_of_one(self) -> float:
        """The mass of a particle where none is given, kg (2-D: kg/m)."""
        return self.rho0 * self.spacing**self.dim

    def fill(self) -> tuple[np.ndarray, float]:
        """See Shaped."""
        position, pivot = self.lattice()
        if self.table.jitter:
            random = np.random.default_rng(self.table.random_seed)
            position += self.table.jitter * self.spacing * random.uniform(-1, 1, position.shape)
        kept = self._kept(self.turned(position, pivot))
        return kept, self.table.mass_per_particle or self.mass_of_one()

    def encloses(self, position: np.ndarray) -> np.ndarray:
        """See Body."""
        where = self.table.where
        if where is None or self.table.given("count"):
            return super().encloses(position)
        inside = inside_bodies(self.scenario, [self.group()], position)
        inside[inside] = self.values_at("where", where, position[inside]) > 0
        return inside

    def _kept(self, position: np.ndarray) -> np.ndarray:
        """The positions where `where` is above zero."""
        if self.table.where is None:
            return position
        kept = position[self.values_at("where", self.table.where, position) > 0]
        if not len(kept):
            raise self.error(".where: it is above zero at no particle of the body", "where")
        return kept
