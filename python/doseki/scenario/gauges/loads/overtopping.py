"""What has gone past a plane, as over the crest of a dam, and what stands behind it."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from ....record.particles import DRIVEN, FIXED
from ....record.units import unit_in
from ...values.types import Direction, Position
from ..gauge import Gauge, Rows, Sampled


class Overtopping(Gauge):
    """Mass and volume that have crossed a plane, and that stand upstream of it."""

    kind: Literal["overtopping"]
    position: Position = Field(description="a point of the plane, as on the crest, m")
    direction: Direction = Field(description="normal of the plane, downstream")

    @property
    def place(self) -> np.ndarray:
        """The point (dim,) of the plane that is given."""
        return self.position

    def is_outside(self, low: np.ndarray, high: np.ndarray) -> bool:
        """Whether its plane passes beside a box; where on it the point lies does not matter."""
        across = (np.array([low, high]) - self.position) * self.normal
        return bool(across.min(axis=0).sum() > 0 or across.max(axis=0).sum() < 0)

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        mass, volume = unit_in("kg", dim), unit_in("m3", dim)
        return {
            "time": "s",
            "mass_upstream": mass,
            "volume_upstream": volume,
            "mass_supplied": mass,
            "mass_passed": mass,
            "volume_passed": volume,
        }

    def since_start(self, dim: int) -> list[str]:
        """What has come and passed counts from the first sample."""
        return ["mass_supplied", "mass_passed", "volume_passed"]

    def rows(self, run: Sampled, plane: int) -> Rows:
        """The time, mass and volume upstream, the mass that has come there other than through the
        plane less what has left there, and mass and volume that have gone through it; `plane` is
        its number in the core, which sees every particle that crosses it.
        """
        state, totals = run.state(), run.totals()
        counts = (state["motion"] != FIXED) & (state["motion"] != DRIVEN)
        counts &= (state["position"] - self.position) @ self.normal < 0
        mass = state["mass"][counts]
        return [
            [
                run.time,
                float(mass.sum()),
                float((mass / state["density"][counts]).sum()),
                totals["plane_supplied"][plane],
                totals["plane_mass"][plane],
                totals["plane_volume"][plane],
            ]
        ]

    @property
    def normal(self) -> np.ndarray:
        """Of length 1, (dim,)."""
        return np.asarray(self.direction / np.linalg.norm(self.direction))
