"""[inflow.NAME]: a section through which particles enter."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from ..array import Array
from ..table import Part
from ..values.types import (
    Depth,
    Direction,
    Duration,
    Hydrograph,
    Instant,
    Length,
    MaterialName,
    Position,
    Rate,
    Surge,
)


class Inflow(Part):
    """A section through which particles enter, at a constant rate or as a hydrograph says."""

    material: MaterialName = Field(description="name of the material that enters")
    rate: Rate | None = Field(None, description='discharge, m3/s, or such as "3 L/s"')
    hydrograph: Hydrograph | None = Field(
        None,
        description="[[t, Q], ...] in s after `start` and m3/s, or a CSV file with columns t and"
        " Q; excludes rate",
    )
    surge: Surge | None = Field(
        None,
        description="[[t, thickness, velocity], ...] in s after `start`, m and m/s, or a CSV file "
        "with these columns; excludes rate, hydrograph and depth",
    )
    width: Length = Field(
        description="from position towards positive axes, m; 2-D: rate/width enters, and "
        "any width will do for a surge"
    )
    position: Position = Field(description="bottom point of the section, m")
    direction: Direction = Field(description="direction of the flow")
    depth: Depth | None = Field(
        None,
        description='m, extent along the section\'s upward normal, or "normal": of uniform flow',
    )
    ks: Length | None = Field(None, description="roughness of the bed in the normal depth, m")
    start: Instant = Field(0.0, description="when it begins, s")
    duration: Duration | None = Field(
        None, description="how long it goes on, s; a hydrograph has its own"
    )
    array: Array | None = Field(None, description="copies; each is an inflow NAME.1, NAME.2 ...")
    jitter: float = Field(
        0.0, ge=0, lt=0.5, description="random displacement along each axis, in spacings"
    )

    @property
    def along(self) -> np.ndarray:
        """Unit vector of the flow."""
        return np.asarray(self.direction / np.linalg.norm(self.direction))

    @property
    def height(self) -> float:
        """The depth in m, once that of uniform flow has been worked out."""
        assert isinstance(self.depth, float)
        return self.depth

    @property
    def rows(self) -> np.ndarray:
        """Rows (n, 2) of time, s, and discharge, m3/s; linear in between but of a surge."""
        if self.surge is not None:
            t, thickness, velocity = np.array(self.surge, dtype=float).T
            return np.column_stack([t + self.start, thickness * velocity * self.width])
        given = self.hydrograph or [[0.0, self.rate], [self.duration, self.rate]]
        return np.array(given, dtype=float) + np.array([self.start, 0.0])

    @property
    def peak_rate(self) -> float:
        """Largest discharge, m3/s."""
        return float(self.rows[:, 1].max())

    def volume_between(self, first: float, last: float) -> float:
        """What enters between two times, s, in m3, at the discharge that it asks for.

        A surge has none: what it brings depends on the ground of its section.
        """
        assert self.surge is None
        times, rates = self.rows.T
        low, high = max(first, times[0]), min(last, times[-1])
        if low >= high:
            return 0.0
        ends = np.unique([low, *times[(times > low) & (times < high)], high])
        return float(np.trapezoid(np.interp(ends, times, rates), ends))
