"""Convex polyhedra from STL files."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...scenario.model import file_of
from ...scenario.tables.bodies import Polyhedron
from ..groups import Group
from ..shapes import Convex, ShapeError, mesh_shape
from .lattice import Turned


class PolyhedronBody(Turned[Polyhedron]):
    """A closed convex polyhedron of a 3-D run."""

    def count(self) -> float:
        """Taken as few: its file is not yet read."""
        return 0.0

    @cached_property
    def _shape(self) -> tuple[Convex, np.ndarray]:
        """What is in its file, which is read but once, and its centre of mass there, m."""
        file = file_of(self.scenario.where, self.name, self.table.file)
        try:
            return mesh_shape(file, self.table.scale)
        except ShapeError as error:
            raise self.error(f": {error}", "file") from None

    def group(self) -> Group:
        """See Body."""
        shape, centre = self._shape
        centre = centre if self.table.centre is None else self.table.centre
        return self.single_group(shape, self.turned(centre[None, :], centre)[0], self.orientation)
