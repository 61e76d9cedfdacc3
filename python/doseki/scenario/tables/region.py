"""[outflow.NAME] and [window.NAME]: axis-aligned boxes."""

from __future__ import annotations

import numpy as np
from pydantic import Field, model_validator

from ..array import Array
from ..table import Part
from ..values.types import Angle, Corner


class Region(Part):
    """An axis-aligned box; its sides may be at infinity."""

    min: Corner = Field(description="lower corner, m")
    max: Corner = Field(description="upper corner, m")

    @model_validator(mode="after")
    def _ordered(self) -> Region:
        if not np.all(self.min < self.max):
            raise ValueError("every entry of min must be below that of max")
        return self


class Outflow(Region):
    """A region in which free particles are removed and counted."""

    array: Array | None = Field(None, description="copies; each is an outflow NAME.1, NAME.2 ...")


class Window(Region):
    """A region that figures and histograms look at."""

    title: str = Field("", description="caption")
    rotate: Angle = Field(
        0.0, description="degrees about the origin, from the first axis towards the last"
    )
