"""What flows across a line on the map: the hydrograph of a section."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ..table import Only
from ..values.types import Length, MapPoint, OptionalMaterialName
from .gauge import Gauge, Rows, Sampled, Setting
from .near import Neighbourhood, particles_in

SLAB = 4.0  # spacings; length of the slab around the section
BIN = 2.0  # spacings; width of the strips of which wet ones are counted
DRY = 0.5  # spacings; depth below which a strip is dry
COLUMNS = {
    "time": "s", "discharge": "m3/s", "mass_rate": "kg/s", "area": "m2", "width": "m",
    "depth": "m", "speed": "m/s",
}  # fmt: skip


class Section(Gauge):
    """Discharge, depth and speed where a flow crosses a line on the map."""

    extents: ClassVar[tuple[str, ...]] = ("length",)

    kind: Literal["section"]
    left: Annotated[MapPoint | None, Only(dim=3)] = Field(
        None, description="[x, y] of the left bank, looking downstream, m; 3-D"
    )
    right: Annotated[MapPoint | None, Only(dim=3)] = Field(
        None, description="[x, y] of the right bank, m; 3-D"
    )
    length: Length | None = Field(
        None, description="of the slab around the section, m; default: 4 dp"
    )
    material: OptionalMaterialName = Field(
        None, description="look only at this material; default: all that moves"
    )

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        return dict(COLUMNS)

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return ["discharge", "depth", "speed"]

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """It is a line on the map of a 3-D run, and its slab holds particles."""
        yield from super().objections(setting)
        if setting.dim != 3:
            yield "kind", ' = "section" is a line on the map of a 3-D run; use "discharge"'
            return
        for key, point in (("left", self.left), ("right", self.right)):
            if point is None:
                yield key, " is missing: give [x, y] of both banks, m"
        if self.left is not None and self.right is not None:
            wide = float(np.hypot(*np.subtract(self.right, self.left)))
            if wide < BIN * setting.dp:
                yield (
                    "right",
                    f" is {wide:g} m from the left bank; at least {BIN:g} dp are needed",
                )

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time; volume and mass that cross per second; area, width, mean depth and speed.

        Discharge counts positive downstream: to the left of the line from the left bank to the
        right one.  The area is that of the flow across the line; the width that of its strips that
        are wet, and depth the mean over them; speed is discharge over area. nan where it is dry.
        """
        assert self.left is not None
        assert self.right is not None
        banks = np.array([self.left, self.right])
        wide = float(np.hypot(*(banks[1] - banks[0])))
        along = (banks[1] - banks[0]) / wide
        normal = np.array([-along[1], along[0]])
        length = self.length or SLAB * setting.dp
        low, high = banks.min(axis=0) - length, banks.max(axis=0) + length
        state = particles_in(run, setting, np.append(low, -np.inf), np.append(high, np.inf))
        around = Neighbourhood(setting, self.material, state)
        away = around.position[:, :2] - banks[0]
        across, beyond = away @ along, away @ normal
        # A hat rather than a box: no particle comes in or goes out with a jump.
        share = np.maximum(0.0, 1 - np.abs(beyond) / (0.5 * length)) / (0.5 * length)
        share *= (across >= 0) & (across < wide)
        speed = share * (around.transport[:, :2] @ normal)
        discharge, area = float(around.volume @ speed), float(around.volume @ share)
        width, depth = _wet(across, around.volume * share, wide, setting.dp)
        mean = discharge / area if width else float("nan")
        return [[run.time, discharge, float(around.mass @ speed), area, width, depth, mean]]


def _wet(across: np.ndarray, area: np.ndarray, wide: float, dp: float) -> tuple[float, float]:
    """Width, m, of the strips of a section in which the flow is deeper than DRY; depth in them, m.

    `across` (n,) says where along the section, m, particles add to its `area` (n,), m2.
    """
    strips = max(1, round(wide / (BIN * dp)))
    strip = wide / strips
    inside = (across >= 0) & (across < wide)
    index = np.minimum((across[inside] / strip).astype(np.int64), strips - 1)
    depths = np.bincount(index, weights=area[inside], minlength=strips) / strip
    wet = depths > DRY * dp
    if not wet.any():
        return 0.0, float("nan")
    return float(np.count_nonzero(wet) * strip), float(depths[wet].mean())
