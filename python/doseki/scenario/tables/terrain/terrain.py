"""[terrain]: the bed as a surface from a map."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from ...table import Only
from ...values.types import Coordinate, Digest, Length, MaterialName
from ...values.units import LENGTH, Measured
from ..wall import WallKeys

TERRAIN = "terrain"  # the name of its body
Extent = Annotated[list[Coordinate], Field(min_length=4, max_length=4), Measured(LENGTH)]
Line = Annotated[list[list[Coordinate]], Field(min_length=2, max_length=2), Measured(LENGTH)]


class Terrain(WallKeys):
    """A bed whose height is a function of place; walls are made where there is flow."""

    file: str = Field(
        description="path, relative to this scenario file: a GeoTIFF or an ESRI ASCII grid; 2-D: a "
        "CSV file with columns x and z, or a grid that is cut along `section`"
    )
    digest: Digest | None = Field(
        None, description="BLAKE2b of the file, 32 hexadecimal digits; another one is refused"
    )
    window: Extent | None = Field(
        None, description="west, south, east, north end of what is used, m; 2-D: of the whole grid"
    )
    resample: Length | None = Field(
        None, description="cells of this size, m; default: those of the file (2-D: dp)"
    )
    smoothing: Length | None = Field(
        None, description="standard deviation of a Gaussian that smooths heights, m"
    )
    section: Annotated[Line | None, Only(dim=2)] = Field(
        None, description="2-D, a grid: the two ends [x, y] of the line on the map that is x, m"
    )
    material: MaterialName = Field(description="name of its material")

    @model_validator(mode="after")
    def _sensible(self) -> Terrain:
        if self.window is not None:
            west, south, east, north = self.window
            if not (west < east and south < north):
                raise ValueError("window is [west, south, east, north], the smaller ones first")
        if self.section is not None:
            if any(len(end) != 2 for end in self.section):
                raise ValueError("section is [[x, y], [x, y]], two places on the map")
            if self.section[0] == self.section[1]:
                raise ValueError("the two ends of section must differ")
        return self
