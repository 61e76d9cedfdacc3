"""The flow through a section."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ...record.units import unit_in
from ..table import Only
from ..values.directions import section_axes
from ..values.types import Direction, Length
from .gauge import FlowGauge, Rows, Sampled, Setting
from .near import Neighbourhood, particles_in

SLAB = 4.0  # spacings; length of the slab around the section


class Discharge(FlowGauge):
    """What flows through a section."""

    extents: ClassVar[tuple[str, ...]] = ("depth", "width", "length")

    kind: Literal["discharge"]
    direction: Direction = Field(description="normal of the section, along which flow counts")
    depth: Length | None = Field(
        None, description="extent upwards from the position, m; default: everything"
    )
    width: Annotated[Length | None, Only(dim=3)] = Field(
        None, description="3-D: extent across, m; default: everything"
    )
    length: Length | None = Field(
        None, description="of the slab around the section, m; default: 4 dp"
    )

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        units = {"time": "s", "discharge": "m3/s", "mass_rate": "kg/s"}
        return {name: unit_in(unit, dim) for name, unit in units.items()}

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, and volume and mass that go through the section per second."""
        normal = self.direction / np.linalg.norm(self.direction)
        length = self.length or SLAB * setting.dp
        up, across = section_axes(normal, setting.gravity)
        # Only a normal along an axis bounds the box; what lies beyond the slab is cut off below.
        bounded = np.abs(normal) > 1 - 1e-9
        low = np.where(bounded, self.position - length, -np.inf)
        high = np.where(bounded, self.position + length, np.inf)
        state = particles_in(run, setting, low, high)
        around = Neighbourhood(setting, self.material, state)
        away = around.position - self.position
        # A hat rather than a box: no particle comes in or goes out with a jump.
        share = np.maximum(0.0, 1 - np.abs(away @ normal) / (0.5 * length)) / (0.5 * length)
        for axis, extent in ((up, self.depth), (across, self.width)):
            if axis is not None and extent is not None:
                share *= (away @ axis >= 0) & (away @ axis <= extent)
        speed = share * (around.transport @ normal)
        return [[run.time, around.volume @ speed, around.mass @ speed]]
