"""What has gone over the crest of a dam, and what stands behind it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np
from pydantic import Field

from ....record.particles import DRIVEN, FIXED
from ....record.units import unit_in
from ...values.types import Direction, Position
from ..gauge import Gauge, Rows, Sampled, Setting


class Overtopping(Gauge):
    """Mass and volume that have crossed a plane, and that stand upstream of it."""

    kind: Literal["overtopping"]
    position: Position = Field(description="a point of the plane, as on the crest, m")
    direction: Direction = Field(description="normal of the plane, downstream")

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

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """The ledger must tell what has come or gone on which side."""
        for low, high in setting.outflows:
            first, last = self._extent(low, high)
            if first < 0 < last:
                yield (
                    "position",
                    f" = {self.position.tolist()}: the plane cuts the outflow from {low.tolist()} "
                    f"to {high.tolist()} m, so that what leaves there may not have crossed it",
                )
                return
        sides_of = {"outflows": self._outflows(setting), "inflows": self._inflows(setting)}
        for name, sides in sides_of.items():
            if len(set(sides)) > 1:
                yield (
                    "position",
                    f" = {self.position.tolist()}: {name} lie on both sides of the plane; what "
                    "passes them is known for all of them together",
                )

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, mass and volume upstream, the mass that inflows have brought there less what
        has left there, and mass and volume downstream with what has left there.
        """
        state = run.state()
        counts = (state["motion"] != FIXED) & (state["motion"] != DRIVEN)
        mass, volume = state["mass"][counts], (state["mass"] / state["density"])[counts]
        below = (state["position"][counts] - self.position) @ self._normal >= 0
        totals = run.totals()
        net = np.array([0.0, 0.0])  # mass and volume that came less what left, downstream
        supplied = totals["mass_entered"] - totals["mass_left"]
        if any(self._outflows(setting)):
            net -= totals["mass_left"], totals["volume_left"]
            supplied += totals["mass_left"]
        if any(self._inflows(setting)):
            net += totals["mass_entered"], totals["volume_entered"]
            supplied -= totals["mass_entered"]
        return [
            [
                run.time,
                float(mass[~below].sum()),
                float(volume[~below].sum()),
                float(supplied),
                float(mass[below].sum() - net[0]),
                float(volume[below].sum() - net[1]),
            ]
        ]

    @property
    def _normal(self) -> np.ndarray:
        return np.asarray(self.direction / np.linalg.norm(self.direction))

    def is_downstream(self, place: np.ndarray) -> bool:
        """Whether a point (dim,) lies beyond the plane."""
        return bool((place - self.position) @ self._normal >= 0)

    def box_is_downstream(self, low: np.ndarray, high: np.ndarray) -> bool:
        """Whether all of a box does."""
        return self._extent(low, high)[0] >= 0

    def _inflows(self, setting: Setting) -> list[bool]:
        return [self.is_downstream(place) for place in setting.inflows]

    def _outflows(self, setting: Setting) -> list[bool]:
        return [self.box_is_downstream(low, high) for low, high in setting.outflows]

    def _extent(self, low: np.ndarray, high: np.ndarray) -> tuple[float, float]:
        """Least and greatest distance beyond the plane in a box whose corners may be infinite."""
        along = self._normal != 0
        ends = np.array([low - self.position, high - self.position])[:, along]
        ends = ends * self._normal[along]
        return float(ends.min(axis=0).sum()), float(ends.max(axis=0).sum())
