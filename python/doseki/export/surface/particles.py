"""Which particles of a snapshot make a surface, and which are solid beside it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...errors import UserError
from ...measure.numbers import speed
from ...measure.views import fluid_names
from ...record.particles import DRIVEN, FIXED
from ...record.reader import Run, Snapshot
from ...scenario.schemes import KERNEL_SUPPORT
from ...util.spelling import suggestion
from .fraction import Cloud

KEYS = ("position", "mass", "density", "smoothing_length", "material", "motion", "velocity",
        "pressure")  # fmt: skip


@dataclass(frozen=True)
class Matter:
    """The cloud of a snapshot; `fields` are those of its particles that are not solid."""

    cloud: Cloud
    fields: dict[str, np.ndarray]
    lost: int  # particles without a finite place

    @property
    def fluid(self) -> Cloud:
        """What the surface is of."""
        return self.cloud.only(~self.cloud.solid)


def chosen_materials(run: Run, names: Iterable[str]) -> list[str]:
    """The materials asked for, or those that flow; raises UserError for one that is not there."""
    there = list(run[0].material_names) if len(run) else []
    for name in names:
        if name not in there:
            raise UserError(
                f"--material {name}: no material of this run{suggestion(name, there)}; "
                f"it has {', '.join(there)}"
            )
    chosen = list(dict.fromkeys(names)) or [n for n in there if n in fluid_names(run)]
    if not chosen:
        raise UserError(
            f"{run.directory}: nothing flows; --material NAME takes the surface of another one"
        )
    return chosen


def matter(snapshot: Snapshot, material: str, kernel: str, flowing: set[str]) -> Matter:
    """What of a snapshot makes the surface of a material.

    Particles of it that are fixed, or behind an inflow and not yet in the run, are no part of it.
    Solid are fixed particles and those of materials that do not flow.
    """
    snapshot.prefetch(KEYS)
    number = list(snapshot.material_names).index(material)
    motion, kind = snapshot["motion"], snapshot.stored("material")
    own = (kind == number) & (motion != FIXED) & (motion != DRIVEN)
    flows = np.isin(kind, [k for k, n in enumerate(snapshot.material_names) if n in flowing])
    solid = ~own & (motion != DRIVEN) & ((motion == FIXED) | ~flows)
    volume = snapshot["mass"] / snapshot["density"]
    reach = KERNEL_SUPPORT[kernel] * snapshot["smoothing_length"]
    finite = np.isfinite(snapshot["position"]).all(axis=1) & (volume > 0) & np.isfinite(volume)
    taken = (own | solid) & finite & (reach > 0)
    lost = int(((own | solid) & ~taken).sum())
    cloud = Cloud(snapshot["position"][taken], volume[taken], reach[taken], solid[taken])
    fluid = own & taken
    velocity = snapshot["velocity"][fluid]
    fields = {
        "Velocity": velocity, "Speed": speed(velocity), "Pressure": snapshot["pressure"][fluid]
    }  # fmt: skip
    return Matter(cloud, fields, lost)


def spacing_of(run: Run, material: str) -> float:
    """Distance between particles of a material, m: the median of the first snapshot that has any.

    Raises UserError where none has.
    """
    for snapshot in run:
        number = list(snapshot.material_names).index(material)
        own = snapshot.stored("material") == number
        volume = (snapshot["mass"] / snapshot["density"])[own & ~snapshot["fixed"]]
        volume = volume[np.isfinite(volume) & (volume > 0)]
        if len(volume):
            return float(np.median(volume)) ** (1 / snapshot.dim)
    raise UserError(f"{run.directory}: nothing of {material} moves in any snapshot")


def kernel_of(run: Run) -> str:
    """The name of the run's kernel."""
    return str(run.scenario.get("kernel", "wendland_c6"))
