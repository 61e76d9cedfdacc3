"""The particles of a snapshot as a block of a view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...figures.dots import grain_radius
from ...measure.views import fluid_names
from ...record.reader import Run, Snapshot
from .box import Box
from .coding import morton_order, packed, wide
from .colours import Field, values_of
from .thinning import Thinning

SWELL = {2: 1.15, 3: 1.25}  # of water and walls: no holes between neighbours


@dataclass(frozen=True)
class Block:
    """Numbers of `count` things, as text; `of` is how many there are in the record."""

    count: int
    text: str
    of: int


class ParticlePacker:
    """Packs what moves, and what does not, of each snapshot of a run."""

    def __init__(self, run: Run, box: Box, fields: Sequence[Field], samples: Sequence[Snapshot]):
        """`samples` say how large particles are."""
        self._box, self._fields = box, fields
        first = samples[0]
        self._fluid = np.isin(first.material_names, sorted(fluid_names(run)))
        self._rank = _ranks(samples)
        self.largest = max(
            (float(np.max(self._radius(s), initial=0.0)) for s in samples), default=0
        )
        self.largest = self.largest or 1e-3 * float(box.size.max())

    def flow(self, snapshot: Snapshot, thinning: Thinning, as_bodies: np.ndarray) -> Block:
        """What moves, but for the particles `as_bodies` (N,), which are drawn as bodies."""
        mask = ~snapshot["fixed"] & ~as_bodies
        return self._block(snapshot, mask, thinning, self._fields)

    def walls(self, snapshot: Snapshot, thinning: Thinning, left_out: np.ndarray) -> Block:
        """What does not move, but for the particles `left_out` (N,)."""
        return self._block(snapshot, snapshot["fixed"] & ~left_out, thinning, ())

    def _radius(self, snapshot: Snapshot) -> np.ndarray:
        swelling = self._fluid[snapshot.stored("material")] | snapshot["fixed"]
        return grain_radius(snapshot) * np.where(swelling, SWELL[snapshot.dim], 1.0)

    def _block(
        self, snapshot: Snapshot, mask: np.ndarray, thinning: Thinning, fields: Sequence[Field]
    ) -> Block:
        position, box = snapshot["position"], self._box
        index = np.flatnonzero(mask & box.holds(position))
        volume = (snapshot["mass"] / snapshot["density"])[index]
        spacing = float(np.median(volume)) ** (1 / box.dim) if len(index) else 1.0
        ids = snapshot["id"][index]
        index = index[thinning.kept(position[index], spacing, ids)]
        place = np.zeros((len(index), 3), np.uint16)
        place[:, : box.dim] = wide(box.share(position[index]))
        if box.dim == 2:  # what is heavy is drawn over what is light
            place[:, 2] = wide(self._rank[snapshot.stored("material")[index]])
            place[:, 2] *= not snapshot["fixed"][index].any()
        order = morton_order(place)
        index, place = index[order], place[order]
        radius = wide(self._radius(snapshot)[index] / self.largest)
        colours = [field.share(values_of(snapshot, field.name)[index]) for field in fields]
        return Block(len(index), packed([*place.T, radius, *colours]), int(mask.sum()))


def _ranks(samples: Sequence[Snapshot]) -> np.ndarray:
    """Between 0 and 1 for each material, by its density: the heaviest is highest."""
    count = len(samples[0].material_names)
    density = np.zeros(count)
    for snapshot in samples:
        for material in np.unique(snapshot.stored("material")):
            density[material] = np.median(
                snapshot["density"][snapshot.stored("material") == material]
            )
    return (1 + np.argsort(np.argsort(density))) / (count + 2)
