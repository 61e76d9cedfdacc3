"""[body.NAME] with shape = "release": what lies on a terrain and begins to flow."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ...table import Only
from ...values.types import Coordinate, Digest
from ...values.units import LENGTH, Measured
from ..body import ShapedBody

Place = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]
Ring = Annotated[list[Place], Field(min_length=3)]
Polygons = Annotated[list[Annotated[list[Ring], Field(min_length=1)]], Field(min_length=1)]
THICKEST = 1e4  # m; no flow is, and layers of particles would never end
Thickness = Annotated[float, Field(gt=0, le=THICKEST)]


class Release(ShapedBody):
    """Areas of a terrain that are covered to a thickness normal to the slope."""

    of_particles: ClassVar[tuple[str, ...]] = ("pressure",)

    shape: Literal["release"]
    file: Annotated[str | None, Only(dim=3)] = Field(
        None,
        description="polygons (GeoJSON, GeoPackage, shapefile) or a raster of thickness (GeoTIFF, "
        "ESRI ASCII), relative to this scenario file",
    )
    digest: Digest | None = Field(
        None, description="BLAKE2b of the file, 32 hexadecimal digits; another one is refused"
    )
    polygon: Annotated[Ring | None, Only(dim=3), Measured(LENGTH)] = Field(
        None, description="the corners [x, y] of one area on the map, m; excludes file"
    )
    polygons: Annotated[Polygons | None, Only(dim=3), Measured(LENGTH)] = Field(
        None,
        description="several areas, each a list of rings (its edge, then holes) of corners "
        "[x, y], m",
    )
    between: Annotated[Place | None, Only(dim=2), Measured(LENGTH)] = Field(
        None, description="2-D: where along x it begins and ends, m"
    )
    thickness: Annotated[Thickness | list[Thickness] | None, Measured(LENGTH)] = Field(
        None,
        description="normal to the slope, m; a list has one for each polygon; default: the "
        "attribute `thickness` of the polygons of the file, or what a raster says",
    )

    @model_validator(mode="after")
    def _one_place(self) -> Release:
        places = ("file", "polygon", "polygons", "between")
        given = [key for key in places if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(
                f"{given[0]} and {given[1]} exclude each other: give one"
                if given
                else "give file or polygon; in 2-D between = [x, x]"
            )
        if self.thickness is None and self.file is None:
            raise ValueError("thickness is missing, m normal to the slope")
        if self.fixed:
            raise ValueError("a release moves; it cannot be fixed")
        if self.between is not None and not isinstance(self.thickness, float):
            raise ValueError("thickness is one number of a release between two places")
        if self.digest is not None and self.file is None:
            raise ValueError("digest goes with file")
        if self.between is not None and not self.between[0] < self.between[1]:
            raise ValueError("between is [x, x], the smaller one first")
        return self
