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
            "mass_passed": mass,
            "volume_passed": volume,
        }

    def since_start(self, dim: int) -> list[str]:
        """What has passed counts from the first sample."""
        return ["mass_passed", "volume_passed"]

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
        for name, sides in (("outflows", self._outflows(setting)), ("inflows", self._inflows(setting))):
            if len(set(sides)) > 1:
                yield (
                    "position",
                    f" = {self.position.tolist()}: {name} lie on both sides of the plane; what "
                    "passes them is known for all of them together",
                )

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, mass and volume upstream, and downstream with what has left there."""
        state = run.state()
        counts = (state["motion"] != FIXED) & (state["motion"] != DRIVEN)
        mass, volume = state["mass"][counts], (state["mass"] / state["density"])[counts]
        below = (state["position"][counts] - self.position) @ self._normal >= 0
        totals = run.totals()
        gone = came = gone_volume = came_volume = 0.0
        if any(self._outflows(setting)):
            gone, gone_volume = totals["mass_left"], totals["volume_left"]
        if any(self._inflows(setting)):
            came, came_volume = totals["mass_entered"], totals["volume_entered"]
        return [
            [
                run.time,
                float(mass[~below].sum()),
                float(volume[~below].sum()),
                float(mass[below].sum()) + gone - came,
                float(volume[below].sum()) + gone_volume - came_volume,
            ]
        ]

    @property
    def _normal(self) -> np.ndarray:
        return np.asarray(self.direction / np.linalg.norm(self.direction))

    def _inflows(self, setting: Setting) -> list[bool]:
        """Whether each section is downstream."""
        return [bool((place - self.position) @ self._normal >= 0) for place in setting.inflows]

    def _outflows(self, setting: Setting) -> list[bool]:
        """Whether each box is downstream."""
        return [self._extent(low, high)[0] >= 0 for low, high in setting.outflows]

    def _extent(self, low: np.ndarray, high: np.ndarray) -> tuple[float, float]:
        """Least and greatest distance beyond the plane in a box whose corners may be infinite."""
        along = self._normal != 0
        ends = np.array([low - self.position, high - self.position])[:, along]
        ends = ends * self._normal[along]
        return float(ends.min(axis=0).sum()), float(ends.max(axis=0).sum())
