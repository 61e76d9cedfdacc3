"""The height of the flow above a point of its bed."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from ..values.directions import upwards
from ..values.types import Direction
from .gauge import FlowGauge, Rows, Sampled, Setting
from .near import REACH, STEP, Neighbourhood, beside, column_height, particles_in, tube


class SurfaceHeight(FlowGauge):
    """Height of the column that stands on a point of the bed."""

    kind: Literal["surface_height"]
    direction: Direction | None = Field(None, description="upwards; default: against gravity")

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        return {"time": "s", "height": "m"}

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, and the height at which the column above the point ends."""
        up, reach = upwards(setting.gravity, self.direction), REACH * setting.dp
        state = particles_in(run, setting, *tube(self.position, up, np.inf, reach))
        around = Neighbourhood(setting, self.material, beside(state, self.position, up, reach))
        return [[run.time, column_height(around, self.position, up, STEP * setting.dp)]]
