"""Boxes."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.tables.bodies import Box
from ..groups import Group
from ..lattices import box_counts, box_lattice
from ..shapes import Edges, PlaneFaces, box_shape
from ..wetting import covered_share
from .box_walls import BoxWalls
from .lattice import Lattice


class BoxBody(Lattice[Box]):
    """A box, whole or filled row by row up to a number of particles."""

    @property
    def counts(self) -> np.ndarray:
        """Particles along each side, as whole floats."""
        return box_counts(self.table.min, self.table.max, self.spacing)

    def count(self) -> float:
        """See Body."""
        if self.kinematics.is_whole:
            return float(np.prod(self.table.max - self.table.min)) / self.spacing**self.dim
        full = float(np.prod(self.counts))
        return min(full, self.table.count or full)

    def lattice(self) -> tuple[np.ndarray, np.ndarray]:
        """See Lattice."""
        self._expect_sides()
        counts, low, high = self.counts, self.table.min, self.table.max
        if not (counts >= 1).all():
            raise self.error(
                f": the box from {low.tolist()} to {high.tolist()} is less than "
                f"one particle thick (dp = {self.spacing:g} m)",
                "max",
            )
        full, count = int(np.prod(counts)), self.table.count
        if count is not None and count > full:
            raise self.error(f".count = {count}: the box holds only {full} particles", "count")
        return box_lattice(low, counts, self.spacing, count or full), low

    def missing_density(self, n: int) -> np.ndarray:
        """See Shaped: of a box that is to be wetted, the share of what will lie on its top."""
        wetted_by = self.table.wetted_by
        if wetted_by is None:
            return super().missing_density(n)
        upright = box_lattice(self.table.min, self.counts, self.spacing, n)
        depth = self.table.max[-1] - upright[:, -1]
        share = covered_share(depth, self.spacing, self.scenario.support, self.dim)
        return self.scenario.materials[wetted_by].rho0 * share

    def group(self) -> Group:
        """See Body."""
        self._expect_sides()
        low, high = self.table.min, self.table.max
        centre = self.turned(0.5 * (low + high)[None, :], low)[0]
        return self.single_group(box_shape(high - low), centre, self.orientation)

    def _expect_sides(self) -> None:
        """Raise UserError where an entry of min is not below that of max."""
        low, high = self.table.min, self.table.max
        if (wrong := np.flatnonzero(~(high > low))).size:
            axis = "xyz"[wrong[0]]
            raise self.error(
                f".max = {high.tolist()}: {high[wrong[0]]:g} m along {axis} is not above "
                f"{low[wrong[0]]:g} m of min; every entry must be",
                "max",
            )

    def contact_shape(self) -> Group | None:
        """See Body."""
        whole = self.table.fixed and self.table.where is None and not self.table.count
        return self.group() if whole else None

    def plane_faces(self) -> PlaneFaces | None:
        """See Body: of a block that does not itself say where the fluid is."""
        if self.table.normal is not None or self.table.where is not None:
            return None
        if self.is_of_bodies or self._walls(ParticleSet.empty(self.dim)).thin_axis is not None:
            return None
        return self._sides_of(self.group())

    def shape_wall(
        self, position: np.ndarray, particles: ParticleSet
    ) -> tuple[np.ndarray, np.ndarray]:
        """See Shaped: a slab faces what moves, a block faces outwards."""
        walls = self._walls(particles)
        axis = walls.thin_axis
        if axis is not None:
            return self.plane_wall(position, walls.side_normal(axis))
        return walls.nearest_face(position)

    def shape_edges(self, position: np.ndarray, particles: ParticleSet) -> Edges:
        """See Shaped: a slab has one face."""
        walls = self._walls(particles)
        if walls.thin_axis is not None:
            return super().shape_edges(position, particles)
        return walls.edges(position)

    def _walls(self, particles: ParticleSet) -> BoxWalls:
        return BoxWalls(self.scenario, self.table, self.rotation, particles)
