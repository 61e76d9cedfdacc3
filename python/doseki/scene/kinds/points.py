"""Particles at given positions."""

from __future__ import annotations

import numpy as np

from ...scenario.tables.bodies import Points
from ..groups import UPRIGHT, Group
from ..shapes import Ball
from .shaped import Shaped


class PointsBody(Shaped[Points]):
    """Particles at given positions; as grains, each is a ball of its mass."""

    def count(self) -> float:
        """See Body."""
        return len(self.table.position)

    def fill(self) -> tuple[np.ndarray, float]:
        """See Shaped."""
        return np.array(self.table.position), self.table.mass

    def group(self) -> Group:
        """See Body."""
        measure = self.table.mass / self.rho0
        ball = Ball((measure / Ball(1.0, self.dim).measure) ** (1 / self.dim), self.dim)
        centre = np.array(self.table.position)
        n = len(centre)
        upright = np.tile(UPRIGHT, (n, 1))
        material = self.table.material
        which = np.zeros(n, np.int32)
        return Group(self.name, [ball], which, centre, upright, material, self.kinematics)
