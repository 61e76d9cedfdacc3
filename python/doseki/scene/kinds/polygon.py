"""Convex polygons."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.tables.bodies import Polygon
from ..groups import Group, edges_of
from ..shapes import Edges, ShapeError, polygon_shape
from .lattice import Turned


class PolygonBody(Turned[Polygon]):
    """A convex polygon of a 2-D run."""

    def count(self) -> float:
        """Taken as few: its corners are given one by one."""
        return 0.0

    def group(self) -> Group:
        """See Body."""
        try:
            shape, centre = polygon_shape(np.array(self.table.vertices))
        except ShapeError as error:
            raise self.error(f": {error}", "vertices") from None
        return self.single_group(shape, self.turned(centre[None, :], centre)[0], self.orientation)

    def shape_edges(self, position: np.ndarray, particles: ParticleSet) -> Edges:
        """See Shaped."""
        return edges_of(self.group(), position)
