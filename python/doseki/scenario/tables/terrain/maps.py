"""[maps]: what a 3-D flow has been at most on the cells of a map."""

from __future__ import annotations

from pydantic import Field, model_validator

from ...table import Table
from ...values.types import Duration, Extent, Length, Speed


class Maps(Table):
    """Maps that are kept while a run goes on."""

    interval: Duration | None = Field(None, description="s between looks; default: time_out")
    cell: Length | None = Field(
        None, description="side of cells, m; a whole multiple of the terrain's; default: that"
    )
    extent: Extent | None = Field(
        None, description="[west, south, east, north], m; default: all of the terrain"
    )
    min_depth: Length | None = Field(
        None, description="m below which a cell counts as dry; default: dp/2"
    )
    speed_deposit: Speed = Field(0.1, description="m/s below which matter has come to rest")

    @model_validator(mode="after")
    def _ordered(self) -> Maps:
        if self.extent is not None:
            west, south, east, north = self.extent
            if not (west < east and south < north):
                raise ValueError("extent is [west, south, east, north]: west < east, south < north")
        return self
