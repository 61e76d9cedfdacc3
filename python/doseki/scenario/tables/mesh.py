"""[body.NAME] with shape = "mesh"."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, model_validator

from ..values.types import Digest, Length, Position, Positive
from .body import TurnedBody

SUFFIXES = (".stl", ".obj", ".ply")


class Mesh(TurnedBody):
    """A fixed surface of triangles in a 3-D run, convex or not: closed, or an open sheet."""

    only_dim: ClassVar[int | None] = 3

    shape: Literal["mesh"]
    fixed: bool = Field(True, description="always true: it moves only as `motion` says")
    file: str = Field(description="path of an STL, OBJ or PLY file, relative to this scenario file")
    digest: Digest | None = Field(
        None, description="BLAKE2b of the file, 32 hexadecimal digits; another one is refused"
    )
    scale: Positive = Field(1.0, description="m per unit of the file")
    position: Position | None = Field(
        None, description="where the origin of the file is put, m; default: the origin"
    )
    sheet: bool = Field(
        False, description="true: the surface is the middle of a wall, which may be open"
    )
    thickness: Length | None = Field(
        None, description="of a sheet, m, half of it on either side; default: what the kernel sees"
    )

    @model_validator(mode="after")
    def _is_a_surface(self) -> Mesh:
        if not self.fixed:
            raise ValueError('a mesh is fixed; a convex body that moves is shape = "stl"')
        if not self.file.lower().endswith(SUFFIXES):
            raise ValueError(f"the name of its file must end in one of {', '.join(SUFFIXES)}")
        if self.normal is not None:
            raise ValueError("its normals are those of its triangles: remove normal")
        if self.thickness is not None and not self.sheet:
            raise ValueError("thickness is that of a sheet: set sheet = true")
        return self
