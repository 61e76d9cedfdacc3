"""Fixed surfaces of triangles."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from ...scenario.model import file_of
from ...scenario.tables.mesh import Mesh
from ...util.finding import Finding
from ..groups import Group
from ..lattices import ROUNDING
from ..meshes.layers import layer_count
from ..meshes.making import MadeMesh, made_mesh, wall_particles
from ..meshes.outside import outside_of
from ..meshes.thin import thin_walls
from ..shapes import ShapeError
from .lattice import Turned


class MeshBody(Turned[Mesh]):
    """A fixed mesh, closed or a sheet: particles below its surface, a surface for bodies."""

    @cached_property
    def made(self) -> MadeMesh:
        """Its surface about the middle of its extent, before it is turned and put in its place."""
        table = self.table
        file = file_of(self.scenario.where, self.name, table.file)
        thickness = (table.thickness or self.depth) if table.sheet else 0.0
        try:
            return made_mesh(file, table.scale, thickness)
        except ShapeError as error:
            raise self.error(f": {error}", "file") from None

    @property
    def depth(self) -> float:
        """Of the wall, m: as many layers as the kernel sees."""
        dp = self.spacing
        return math.ceil(self.scenario.support / dp - 0.5 - ROUNDING) * dp

    @property
    def centre(self) -> np.ndarray:
        """Where the middle of its extent is, m."""
        origin = np.zeros(3) if self.table.position is None else np.asarray(self.table.position)
        return np.asarray(self.turned((origin + self.made.middle)[None, :], origin)[0])

    def count(self) -> float:
        """See Body."""
        return layer_count(self.made.shape, self.spacing, self.depth)

    def fill(self) -> tuple[np.ndarray, float]:
        """See Shaped."""
        own = wall_particles(self.made.shape, self.spacing, self.depth)
        if not len(own):
            raise self.error(
                f": nothing of it is as thick as one particle (dp = {self.spacing:g} m)", "file"
            )
        return self.centre + own @ self.rotation.T, self.rho0 * self.spacing**3

    def contact_shape(self) -> Group | None:
        """See Body."""
        return self.single_group(self.made.shape, self.centre, self.orientation)

    def faces(self) -> np.ndarray:
        """See Body: its triangles; those of both sides and of the rims of a sheet."""
        corners = outside_of(self.made.shape)
        return np.asarray(self.centre + corners @ self.rotation.T)

    def wall(self, position: np.ndarray, particles: object) -> tuple[np.ndarray, np.ndarray]:
        """See Body: outwards from the nearest triangle, the mean of faces beside an edge."""
        own = (position - self.centre) @ self.rotation
        normal, depth = self.made.shape.wall(own, self.spacing)
        return normal @ self.rotation.T, depth

    def findings(self) -> list[Finding]:
        """See Body."""
        thin = thin_walls(self.name, self.made.shape, self.spacing, self.depth)
        return [*self.made.findings(self.name), *thin]
