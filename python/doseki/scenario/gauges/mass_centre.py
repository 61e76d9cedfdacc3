"""The centre of mass of what moves, of a material or of bodies."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ...record.particles import DRIVEN, FIXED
from ...record.units import unit_in
from ..values.types import OptionalMaterialName, RefersTo
from .gauge import Gauge, Rows, Sampled, Setting

SPREAD = 1e-6  # length of the mean unit vector below which matter is all around a periodic axis


class MassCentre(Gauge):
    """Position and velocity of a centre of mass."""

    kind: Literal["mass_centre"]
    material: OptionalMaterialName = Field(
        None, description="look only at this material; default: all that moves"
    )
    bodies: Annotated[list[str] | None, RefersTo("body"), Field(min_length=1)] = Field(
        None, description="names of bodies, fixed ones too; default: all that moves"
    )

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        axes = "xyz"[:dim]
        position, velocity = dict.fromkeys(axes, "m"), {f"velocity_{axis}": "m/s" for axis in axes}
        return {"time": "s", "mass": unit_in("kg", dim)} | position | velocity

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return [name for name in self.columns(dim) if name not in ("time", "mass")]

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, the mass that counts, its centre and the velocity of that; nan without mass.

        Bodies count by their particles, which share their mass and have their centre.  Along a
        periodic axis the centre is the circular mean (Bai & Breen 2008, doi:10.1080/2151237X.2008.
        10129266), nan where matter is evenly all around.
        """
        state = run.state()
        counts = setting.is_of_material(self.material, state) & (state["motion"] != DRIVEN)
        if self.bodies is None:
            counts &= state["motion"] != FIXED
        else:
            counts &= setting.is_of_bodies(self.bodies, state)
        mass = state["mass"][counts]
        total = float(mass.sum())
        if total == 0.0:
            return [[run.time, 0.0, *np.full(2 * setting.dim, np.nan)]]
        position = state["position"][counts]
        centre = mass @ position / total
        for axis, low, high in setting.periods():
            centre[axis] = _circular_mean(position[:, axis], mass / total, low, high)
        return [[run.time, total, *centre, *(mass @ state["velocity"][counts] / total)]]


def _circular_mean(x: np.ndarray, share: np.ndarray, low: float, high: float) -> float:
    """Mean of positions (N,) on the circle from `low` to `high`, m; `share` (N,) of the mass."""
    turn = (high - low) / (2 * np.pi)
    mean = complex(share @ np.exp(1j * (x - low) / turn))
    return low + float(np.angle(mean)) % (2 * np.pi) * turn if abs(mean) > SPREAD else float("nan")
