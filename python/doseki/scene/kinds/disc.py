"""Discs and spheres."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.kinematics import FIXED, SINGLE
from ...scenario.schemes import RESOLVED
from ...scenario.tables.bodies import Disc
from ..groups import Group
from ..lattices import ball_measure, disc_lattice
from ..shapes import Ball
from .lattice import Lattice


class DiscBody(Lattice[Disc]):
    """A disc or sphere, on a lattice or as one particle."""

    @property
    def is_of_bodies(self) -> bool:
        """Water meets a ball at its surface whether it moves or not: a whole one of a solid is one.

        A lattice cut along a circle has up to a tenth less area, and less buoyancy.
        """
        return super().is_of_bodies or (self.table.fixed and self._is_round)

    @property
    def _is_round(self) -> bool:
        """Whether the table asks for a whole ball of a solid, and nothing of a lattice."""
        table = self.table
        given = (table.mass_per_particle, table.normal, table.where, table.pressure)
        cut = table.fill != "lattice" or table.jitter > 0 or any(x is not None for x in given)
        solid = self.scenario.materials[table.material].law == "solid"
        return solid and self.scenario.scheme == RESOLVED and not cut

    def count(self) -> float:
        """On a lattice, the number of its bounding box."""
        if self.is_of_bodies:
            if self.kinematics is SINGLE:
                return 1
            return ball_measure(self.table.radius, self.dim) / self.spacing**self.dim + 1
        across = 2 * self.table.radius / self.spacing + 3
        return across**self.dim if self.table.fill == "lattice" else 1

    def lattice(self) -> tuple[np.ndarray, np.ndarray]:
        """See Lattice."""
        centre = self.table.centre
        if self.table.fill == "lattice":
            return disc_lattice(centre, self.table.radius, self.spacing), centre
        return centre[None, :].copy(), centre

    def mass_of_one(self) -> float:
        """See Lattice."""
        if self.table.fill == "lattice":
            return super().mass_of_one()
        return self.rho0 * ball_measure(self.table.radius, self.dim)

    def group(self) -> Group:
        """See Body."""
        centre = self.turned(self.table.centre[None, :], self.table.centre)[0]
        return self.single_group(Ball(self.table.radius, self.dim), centre, self.orientation)

    def contact_shape(self) -> Group | None:
        """See Body."""
        whole = self.table.fixed and self.table.where is None
        return replace(self.group(), kinematics=FIXED) if whole else None

    def shape_wall(
        self, position: np.ndarray, particles: ParticleSet
    ) -> tuple[np.ndarray, np.ndarray]:
        """See Shaped: outwards from the centre."""
        out = position - self.table.centre
        distance = np.linalg.norm(out, axis=1)
        unit = out / np.maximum(distance, 1e-300)[:, None]
        return unit, self.table.radius - distance
