"""Convex polygons."""

from __future__ import annotations

import numpy as np

from ...scenario.tables.bodies import Polygon
from ..groups import Group
from ..shapes import ShapeError, polygon_shape
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
