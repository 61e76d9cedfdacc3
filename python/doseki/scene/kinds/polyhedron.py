"""Convex polyhedra from STL files."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.model import file_of
from ...scenario.tables.bodies import Polyhedron
from ..groups import Group, edges_of
from ..shapes import Edges, ShapeError, mesh_shape
from .lattice import Turned


class PolyhedronBody(Turned[Polyhedron]):
    """A closed convex polyhedron of a 3-D run."""

    def count(self) -> float:
        """Taken as few: its file is not yet read."""
        return 0.0

    def group(self) -> Group:
        """See Body."""
        file = file_of(self.scenario.where, self.name, self.table.file)
        try:
            shape, centre = mesh_shape(file, self.table.scale)
        except ShapeError as error:
            raise self.error(f": {error}", "file") from None
        centre = centre if self.table.centre is None else self.table.centre
        return self.single_group(shape, self.turned(centre[None, :], centre)[0], self.orientation)

    def shape_edges(self, position: np.ndarray, particles: ParticleSet) -> Edges:
        """See Shaped."""
        return edges_of(self.group(), position)
