"""Convex polyhedra from STL files."""

from __future__ import annotations

from ...scenario.model import file_of
from ...scenario.tables.bodies import Polyhedron
from ..groups import Group
from ..shapes import ShapeError, mesh_shape
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
