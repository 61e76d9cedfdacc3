"""The pressure at a point of a wall."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..values.types import Length
from .gauge import FlowGauge, Rows, Sampled, Setting
from .near import REACH, Neighbourhood, particles_in


class PressureGauge(FlowGauge):
    """Mean pressure of what is near a point of a wall."""

    kind: Literal["pressure"]
    radius: Length | None = Field(None, description="of the mean, m; default: 3 dp")

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        return {"time": "s", "pressure": "Pa"}

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, and the mean pressure of what lies around the point."""
        radius = self.radius or REACH * setting.dp
        state = particles_in(run, setting, self.position - radius, self.position + radius)
        around = Neighbourhood(setting, self.material, state)
        weights = around.weights(self.position, radius)
        total = weights.sum()
        return [[run.time, weights @ around.pressure / total if total > 0 else 0.0]]
