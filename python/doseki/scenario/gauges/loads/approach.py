"""The flow that comes: depth, speed and density at a section."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ...table import Only
from ...values.directions import section_axes
from ...values.types import Direction, Length
from ..gauge import FlowGauge, Rows, Sampled, Setting
from ..near import (
    REACH,
    STEP,
    Neighbourhood,
    bed_height,
    beside,
    column_height,
    particles_in,
)

SLAB = 4.0  # spacings; length of the slab around the section
APART = 4.0  # spacings between two columns across a section
MOST = 25  # columns across a section


class Approach(FlowGauge):
    """Depth, mean speed and density of the flow through a section."""

    extents: ClassVar[tuple[str, ...]] = ("width", "length")

    kind: Literal["approach"]
    direction: Direction = Field(description="normal of the section, along which speed counts")
    width: Annotated[Length | None, Only(dim=3)] = Field(
        None, description="3-D: extent across, m; default: one column, at the position"
    )
    length: Length | None = Field(
        None, description="of the slab around the section, m; default: 4 dp"
    )

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        return {"time": "s", "depth": "m", "velocity": "m/s", "density": "kg/m3"}

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, the mean depth of columns on the bed, and of what is in them the speed
        along the normal, a mean by mass, and the density; nan where there is none.

        A column begins on the wall nearest to its foot: natural sections are not level.
        """
        normal = self.direction / np.linalg.norm(self.direction)
        length, reach = self.length or SLAB * setting.dp, REACH * setting.dp
        up, across = section_axes(normal, setting.gravity)
        feet = self._feet(across, setting)
        margin = max(length, reach)
        low, high = feet.min(axis=0) - margin, feet.max(axis=0) + margin
        along = np.abs(up) > 1e-9
        low, high = np.where(along, -np.inf, low), np.where(along, np.inf, high)
        state = particles_in(run, setting, low, high)
        step, bottoms, tops = STEP * setting.dp, [], []
        for foot in feet:
            near = Neighbourhood(setting, self.material, beside(state, foot, up, reach))
            bottom = bed_height(near, foot, up, step)
            bottoms.append(bottom)
            tops.append(bottom + column_height(near, foot + bottom * up, up, step))
        depth = float(np.mean(np.subtract(tops, bottoms)))
        around = Neighbourhood(setting, self.material, state)
        away = around.position - self.position
        share = np.maximum(0.0, 1 - np.abs(away @ normal) / (0.5 * length))
        share *= (away @ up >= min(bottoms)) & (away @ up <= max(tops))
        if across is not None:
            first, last = (0.0, self.width) if self.width else (-reach, reach)
            share *= (away @ across >= first) & (away @ across <= last)
        mass, volume = float(share @ around.mass), float(share @ around.volume)
        if depth == 0.0 or mass == 0.0:
            return [[run.time, depth, np.nan, np.nan]]
        speed = float((share * around.mass) @ (around.velocity @ normal)) / mass
        return [[run.time, depth, speed, mass / volume]]

    def feet(self, setting: Setting) -> np.ndarray:
        """Where its columns stand (k, dim), m."""
        _, across = section_axes(self.direction / np.linalg.norm(self.direction), setting.gravity)
        return self._feet(across, setting)

    def _feet(self, across: np.ndarray | None, setting: Setting) -> np.ndarray:
        """Where the columns stand (k, dim), m."""
        if across is None or not self.width:
            return self.position[None, :]
        count = int(np.clip(self.width / (APART * setting.dp), 1, MOST))
        return self.position + np.outer((np.arange(count) + 0.5) / count * self.width, across)
