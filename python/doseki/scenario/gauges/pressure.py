"""The pressure at a point of a wall."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ..schemes import RESOLVED
from ..values.types import Direction, Length, Positive
from ..values.units import AREA, FREQUENCY, LENGTH, Measured
from .face import Face, at_surface
from .gauge import FlowGauge, Rows, Sampled, Setting
from .near import REACH, Neighbourhood, particles_in


class PressureGauge(FlowGauge):
    """Mean pressure of what is near a point of a wall, or on a piece of it."""

    extents: ClassVar[tuple[str, ...]] = ("radius",)

    kind: Literal["pressure"]
    radius: Length | None = Field(None, description="of the mean, m; default: 3 dp")
    area: Annotated[Positive, Measured(AREA, plane=LENGTH)] | None = Field(
        None, description="of a sensor in the wall, m2 of a disc; 2-D: its length, m"
    )
    direction: Direction | None = Field(
        None, description="with `area`: normal of its face, into the flow; default: the wall's"
    )
    filter_hz: Annotated[Positive, Measured(FREQUENCY)] | None = Field(
        None, description="bandwidth of the sensor, Hz: a Butterworth low-pass of second order"
    )

    @property
    def bandwidth(self) -> float | None:
        """Of the filter that its reading goes through at each step, Hz."""
        return self.filter_hz

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        plain = {"time": "s", "pressure": "Pa"}
        filtered = {"peak": "Pa", "raw": "Pa", "impulse": "Pa s"}
        return plain if self.filter_hz is None else plain | filtered

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return ["pressure"]

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """A face is one of a wall that knows its pressure; no filter is faster than the steps."""
        yield from super().objections(setting)
        if self.area is not None:
            yield from self._objections_to_face(setting)
        elif self.direction is not None:
            yield "direction", ": only a gauge with area has a face"
        fastest = 0.5 / setting.timestep
        if self.filter_hz is not None and self.filter_hz > fastest:
            yield (
                "filter_hz",
                f" = {self.filter_hz:g} Hz is more than steps can show; they are up to "
                f"{setting.timestep:.3g} s long, so at most {fastest:.3g} Hz",
            )

    def _objections_to_face(self, setting: Setting) -> Iterator[tuple[str, str]]:
        if setting.scheme != RESOLVED:
            yield "area", f' needs scheme = "resolved"; {setting.scheme} has no pressure of walls'
        for key in ("radius", "material"):
            if getattr(self, key) is not None:
                yield key, ": a gauge with area is the mean over its face and takes none"

    def face(self, dp: float) -> Face | None:
        """Its face, if it is a sensor in a wall."""
        if self.area is None:
            return None
        return Face(self.position, self.area, dp, self.direction)

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, and the mean pressure of what lies around the point, or on the face."""
        face = self.face(setting.dp)
        reach = face.reach if face else self.radius or REACH * setting.dp
        state = particles_in(run, setting, self.position - reach, self.position + reach)
        if face:
            weights, pressure = face.weights(state), at_surface(state, setting.gravity)
        else:
            around = Neighbourhood(setting, self.material, state)
            weights, pressure = around.weights(self.position, reach), around.pressure
        total = float(np.sum(weights))
        return [[run.time, float(weights @ pressure) / total if total > 0 else 0.0]]
