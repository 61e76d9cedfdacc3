"""Grains: discs or spheres packed at random into a box."""

from __future__ import annotations

import numpy as np

from ...errors import UserError
from ...scenario.kinematics import FIXED, SINGLE
from ...scenario.tables.bodies import Grains
from ..groups import Group
from ..lattices import rotated
from ..packing import PackingError, pack, solid_fraction
from ..periodic import periods
from ..shapes import Ball, Shape, box_shape
from .lattice import Turned

PACKING = {2: 0.75, 3: 0.55}  # solid fraction of a box filled with grains
DENSEST = {
    2: 0.91,
    3: 0.74,
}  # of any arrangement of equal ones (a little over pi/sqrt(12), pi/sqrt(18))
MOST_GRAINS = 10_000_000


class GrainsBody(Turned[Grains]):
    """Grains of one diameter or of several, filled from the bottom of their box upwards."""

    @property
    def size(self) -> np.ndarray:
        """Sides (dim,) of the box, m."""
        return self.table.max - self.table.min

    def count(self) -> float:
        """At most, or nearly: the space of the box over that of a particle."""
        if self.kinematics is SINGLE:
            return 1
        return float(np.prod(self.size)) / self.spacing**self.dim

    def group(self) -> Group:
        """Grains at random in the box, up to the level where they have their solid fraction."""
        table = self.table
        random = np.random.default_rng(table.random_seed)
        diameters, kind = self._sizes()
        kind = random.permutation(kind)
        radius, high = 0.5 * diameters[kind], table.max.copy()
        fraction = solid_fraction(radius, table.min, high)
        if (table.count or table.mass_total) and table.packing is not None:
            high[-1] = table.min[-1] + fraction / table.packing * (high[-1] - table.min[-1])
            if high[-1] > table.max[-1] * (1 + 1e-9 * np.sign(table.max[-1])):
                raise self._too_many(len(kind), table.packing, fraction)
            fraction = table.packing
        try:
            centre = pack(radius, table.min, high, table.random_seed)
        except PackingError as error:
            raise self._too_dense(len(kind), fraction, error.reached) from None
        centre = self.turned(centre, table.min)
        shapes: list[Shape] = [Ball(0.5 * d, self.dim, table.wetted) for d in diameters]
        turned = np.tile(self.orientation, (len(kind), 1))
        which, material = kind.astype(np.int32), table.material
        return Group(self.name, shapes, which, centre, turned, material, self.kinematics)

    def _too_many(self, count: int, requested: float, needed: float) -> UserError:
        return self.error(
            f": {count} grains at a solid fraction of {requested:.3g} do not fit into "
            f"the box, whose fraction would have to be {needed:.3g}: make it larger"
        )

    def _too_dense(self, count: int, requested: float, reached: float) -> UserError:
        return self.error(
            f": {count} grains do not pack to a solid fraction of {requested:.3g} in "
            f"this box; {reached:.3g} was reached: lower packing, or make the box larger"
        )

    def _sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Diameters, and which of them each grain has."""
        table = self.table
        rows = np.array(table.rows)
        diameters, share = rows[:, 0], rows[:, 1] / rows[:, 1].sum()
        measure = np.array([Ball(0.5 * d, self.dim).measure for d in diameters])
        mean = 1 / (share / measure).sum()  # of a grain: numbers are mass over mass of a grain
        total = float(np.prod(self.size)) * (table.packing or PACKING[self.dim])
        if table.mass_total is not None:
            slice_width = table.width if self.dim == 2 else 1.0
            total = table.mass_total / slice_width / self.rho0
        number = table.count or total / mean
        self._check_possible(number, number * mean / float(np.prod(self.size)), len(diameters))
        numbers = number * mean * share / measure
        whole = np.floor(numbers).astype(int)
        missing = round(numbers.sum()) - whole.sum()
        whole[np.argsort(whole - numbers, kind="stable")[:missing]] += 1
        if whole.sum() == 0:
            raise self.error(f": not one grain of d = {diameters.min():g} m fits its mass or box")
        return diameters, np.repeat(np.arange(len(diameters)), whole)

    def _check_possible(self, number: float, fraction: float, sizes: int) -> None:
        """Refuse what no arrangement of grains can be, before any is looked for.

        Smaller grains may at best fill the gaps of larger ones as densely as those fill the box.
        """
        densest = 1 - (1 - DENSEST[self.dim]) ** sizes
        fraction = max(fraction, self.table.packing or 0.0)
        if not fraction <= densest:
            raise self.error(
                f": grains would fill {fraction:.3g} of their box; no arrangement fills more than "
                f"{densest:.3g}: lower packing, count or mass_total, or make the box larger"
            )
        if not number <= MOST_GRAINS:
            raise self.error(f": {number:.3g} grains; at most {MOST_GRAINS:g} are packed")

    def sides(self, thickness: float) -> list[Group]:
        """Walls along the sides of the box, from well below to well above it.

        Periodic axes that the box spans have none.
        """
        table = self.table
        pivot = table.min if table.pivot is None else table.pivot
        found = []
        for axis in range(self.dim - 1):
            if self._spans(axis):
                continue
            extent = self.size + 2 * thickness
            extent[-1], extent[axis] = 3 * self.size[-1], thickness
            for edge, outwards in ((table.min, -0.5), (table.max, 0.5)):
                centre = 0.5 * (table.min + table.max)
                centre[axis] = edge[axis] + outwards * thickness
                centre = rotated(centre[None, :], table.rotate, pivot, self.axis)
                found.append(
                    Group(
                        self.name,
                        [box_shape(extent)],
                        np.zeros(1, np.int32),
                        centre,
                        self.orientation[None, :],
                        table.material,
                        FIXED,
                    )
                )
        return found

    def _spans(self, axis: int) -> bool:
        """Whether the box is as long as the period along an axis."""
        period = periods(self.scenario)[axis]
        return bool(not self.table.rotate and period and self.size[axis] > 0.999 * period)
