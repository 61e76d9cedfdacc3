"""Velocities along a line from the bed."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from ..values.directions import upwards
from ..values.types import Direction, Length
from .gauge import FlowGauge, Rows, Sampled, Setting
from .near import INSIDE, REACH, Neighbourhood, particles_in, tube


class VelocityProfile(FlowGauge):
    """Velocity at points along a line from the bed."""

    is_profile: ClassVar[bool] = True
    extents: ClassVar[tuple[str, ...]] = ("length",)

    kind: Literal["velocity_profile"]
    direction: Direction | None = Field(None, description="of the line; default: against gravity")
    length: Length = Field(description="of the line, m")
    count: int = Field(20, gt=0, le=10_000, description="points, at (k + 1/2) length/count")

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        velocities = {f"velocity_{axis}": "m/s" for axis in "xyz"[:dim]}
        return {"time": "s", "height": "m"} | velocities | {"fraction": "1"}

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return [f"velocity_{axis}" for axis in "xyz"[:dim]]

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """One row for each point of the line; no velocity where there is no flow."""
        up, reach = upwards(setting.gravity, self.direction), REACH * setting.dp
        state = particles_in(run, setting, *tube(self.position, up, self.length, reach))
        around = Neighbourhood(setting, self.material, state)
        rows = []
        for height in (np.arange(self.count) + 0.5) * self.length / self.count:
            x = self.position + height * up
            fraction, velocity = around.fraction(x), np.full(setting.dim, np.nan)
            if fraction >= INSIDE:
                weights = around.weights(x)
                velocity = weights @ around.velocity / weights.sum()
            rows.append([run.time, height, *velocity, fraction])
        return rows
