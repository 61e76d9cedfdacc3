"""The load on fixed bodies: what water and grains give to them, and what a designer expects."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ...table import Only
from ...values.types import BodyNames, Length, RefersTo
from ..gauge import Rows, Sampled, Setting
from .force_meter import ForceMeter, about_axes, force_columns, impulse_of
from .metered import Row
from .standing_water import Known, standing_water
from .surface import Box

PARTS = ("static", "dynamic", "contact")


class Load(ForceMeter):
    """Force and moment on fixed bodies, in parts: water at rest, its motion, and contacts."""

    kind: Literal["load"]
    bodies: BodyNames = Field(description="names of fixed bodies")
    approach: Annotated[str | None, RefersTo("gauge")] = Field(
        None, description="gauge of kind approach in the flow that comes, for design formulas"
    )
    width: Annotated[Length | None, Only(dim=3)] = Field(
        None, description="3-D, with `approach`: of the structure that the flow meets, m"
    )

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        peaks = {"peak_time": "s", "hit_speed": "m/s", "hit_radius": "m"}
        return {"time": "s"} | _forces(dim) | peaks

    def since_before(self, dim: int) -> list[str]:
        """Means and peaks since the sample before."""
        return list(_forces(dim))

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return [name for name in force_columns("", dim) if name.startswith("force")]

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """A width is that of design formulas, which in 3-D need one."""
        yield from super().objections(setting)
        if self.approach is None and self.width is not None:
            yield "width", ": only a gauge with approach has one"
        if self.approach is not None and self.width is None and setting.dim == 3:
            yield "width", " is missing: that of the structure, for the formulas of `approach`"

    def static(
        self, run: Sampled, setting: Setting, box: Box, known: Known | None = None
    ) -> np.ndarray:
        """Force and moment (m,) of the water that stands against the bodies, Eq. (96)."""
        about = self.pole(setting.dim)
        return np.concatenate(standing_water(run, setting, self.bodies, about, box, known))

    def sums(self, row: Row, dim: int) -> np.ndarray:
        """Impulses (2, m) of flow and contacts since the start, of force and moment."""
        return np.array([impulse_of(row, name, dim) for name in ("flow", "contact")])

    def rows(self, time: float, row: Row, static: np.ndarray, means: np.ndarray) -> Rows:
        """A sample: `static` (m,) and the `means` (2, m) of flow and contacts since the last."""
        dim = len(row["peak_force"])
        flow, contact = means
        parts = [flow + contact, static, flow - static, contact]
        peak = np.concatenate([row["peak_force"], about_axes(row["peak_moment"], dim)])
        seen = float(row["peak_time"])
        last = [*peak, seen] if seen >= 0 else [np.nan] * (len(peak) + 1)
        hit = [float(row["hit_speed"]), float(row["hit_radius"])]
        return [[time, *np.concatenate(parts).tolist(), *map(float, last), *hit]]


def _forces(dim: int) -> dict[str, str]:
    """Columns of the whole, of its parts and of its peak, with their units."""
    named: dict[str, str] = {}
    for part in ("", *(f"{part}_" for part in PARTS), "peak_"):
        named |= force_columns(part, dim)
    return named
