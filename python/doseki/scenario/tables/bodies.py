"""[body.NAME] of each shape."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from ..kinematics import SINGLE, Kinematics
from ..table import Kinds, Only
from ..values.types import (
    Digest,
    Duration,
    Grading,
    Length,
    Mass,
    MaterialName,
    OptionalMaterialName,
    ParticleMass,
    Position,
    Positive,
    Vector,
)
from ..values.units import LENGTH, Measured
from .body import BodyTable, LatticeBody, ShapedBody, TurnedBody
from .mesh import Mesh
from .motion import Motion
from .terrain.release import Release
from .wall import WallKeys

TILT = 1e-6  # of a unit vector, by which rounding may turn it
Side = Literal["-x", "+x", "-y", "+y", "-z", "+z"]


class Box(LatticeBody):
    """Particles at min + (k + 1/2) dp, round(length/dp) of them along each side."""

    shape: Literal["box"]
    min: Position = Field(description="lower corner before rotation, m")
    max: Position = Field(description="upper corner before rotation, m")
    count: int | None = Field(
        None, gt=0, description="keep this many particles, filled row by row from below"
    )
    wetted_by: OptionalMaterialName = Field(
        None,
        description="material that lies on its top at rest: the density is such that the cover "
        "brings it to rho0; else whatever comes to a dry bed hovers one support above it",
    )

    @model_validator(mode="after")
    def _wetted_whole(self) -> Box:
        if self.wetted_by is not None and self.where is not None:
            raise ValueError("wetted_by and where exclude each other: a wetted box is whole")
        return self

    @model_validator(mode="after")
    def _normal_of_a_face(self) -> Box:
        """A part that `where` leaves may have any face."""
        normal = None if self.where is not None else self.normal
        if normal is not None and np.sum(np.abs(normal) > TILT * np.abs(normal).max()) > 1:
            raise ValueError(
                f"normal = {normal.tolist()} is no normal of a face of the box, which lies along "
                "the axes and is turned by rotate, normal and all; a plane at a slant is a box "
                "with rotate"
            )
        return self

    def filled_size(self, dp: float) -> np.ndarray:
        """Its sides (dim,), m, in whole particles, of spacing `dp` where it has none of its own."""
        spacing = self.dp or dp
        return np.asarray(spacing * np.rint((self.max - self.min) / spacing))

    def layers(self, dp: float) -> int | None:
        """Particles of spacing `dp`, m, across its thinnest side."""
        return round(float(np.min(self.max - self.min)) / (self.dp or dp))


class Disc(LatticeBody):
    """A disc (2-D) or sphere (3-D) on a lattice centred on a particle, or one single particle."""

    can_be_single: ClassVar[bool] = True

    shape: Literal["disc", "sphere"]
    centre: Position = Field(description="its centre, m")
    radius: Length = Field(description="its radius, m")
    fill: Literal["lattice", "single"] = Field(
        "lattice", description="lattice: particles nearer than radius; single: one with its mass"
    )

    @property
    def smallest(self) -> float | None:
        """See BodyTable."""
        return 2 * self.radius

    @model_validator(mode="after")
    def _one_particle(self) -> Disc:
        if self.fill == "lattice":
            return self
        if self.kinematics not in (None, "single"):
            raise ValueError(f'fill = "single" is no body with kinematics = "{self.kinematics}"')
        if self.dp is not None:
            raise ValueError('fill = "single" excludes dp: one particle has no spacing')
        if "rotate" in self.model_fields_set and self.pivot is None:
            raise ValueError('fill = "single" is rotated only about a pivot elsewhere: give one')
        return self

    def kinematics_in(self, scheme: str, law: str | None) -> Kinematics:
        """As of any body; a ball that is one particle moves as one."""
        found = super().kinematics_in(scheme, law)
        return SINGLE if found.is_whole and self.fill == "single" else found


class Grains(TurnedBody):
    """Discs (2-D) or spheres (3-D) packed at random into a box, from its bottom upwards."""

    is_solid: ClassVar[bool] = True
    can_be_single: ClassVar[bool] = True

    shape: Literal["disc", "sphere"]
    min: Position = Field(description="lower corner of the box before rotation, m")
    max: Position = Field(description="upper corner of the box before rotation, m")
    d: Length | None = Field(None, description="diameter, m; excludes grading")
    grading: Grading | None = Field(
        None, description="[[d, share], ...] in m and parts of the mass; excludes d"
    )
    count: int | None = Field(None, gt=0, description="number of grains; excludes mass_total")
    mass_total: Mass | None = Field(
        None, description='kg or a string such as "20 kg"; default: what fills the box'
    )
    width: Annotated[Length, Only(dim=2)] = Field(
        1.0, description="2-D: m; mass_total is that of a slice so wide"
    )
    packing: float | None = Field(
        None,
        gt=0,
        lt=1,
        description="solid fraction; with count or mass_total the box is filled up to a level, and "
        "without packing evenly all over (default 0.75, in 3-D 0.55)",
    )
    wetted: float = Field(
        1.0,
        gt=0.3,
        le=1,
        description="diameter that water sees over the true one; below 1 in 2-D, where discs that "
        "touch would leave water no way between them",
    )
    random_seed: int = Field(1, ge=0, description="of the packing")
    settle: bool | Duration = Field(
        False,
        description="settle dry under gravity before the start, between the sides of "
        "the box: true, until at rest, or s",
    )

    @model_validator(mode="after")
    def _fits_together(self) -> Grains:
        if (self.d is None) == (self.grading is None):
            raise ValueError("give either d or grading")
        if self.count is not None and self.mass_total is not None:
            raise ValueError("count and mass_total exclude each other: give one")
        if "width" in self.model_fields_set and self.mass_total is None:
            raise ValueError("width goes with mass_total, which is that of a slice so wide")
        if not np.all(self.min < self.max):
            raise ValueError("every entry of min must be below that of max")
        return self

    @property
    def described(self) -> str:
        """The keys that make it what it is, for messages."""
        return f"{super().described} with d"

    @property
    def smallest(self) -> float | None:
        """See BodyTable."""
        return min(diameter for diameter, _ in self.rows)

    @property
    def rows(self) -> list[list[float]]:
        """Rows [diameter, m; share of the mass]."""
        return [[self.d, 1.0]] if self.d is not None else self.grading or []


class Polygon(TurnedBody):
    """A convex polygon of a 2-D run."""

    only_dim: ClassVar[int | None] = 2
    is_solid: ClassVar[bool] = True

    shape: Literal["polygon"]
    vertices: Annotated[list[Vector], Measured(LENGTH)] = Field(
        description="its corners in order, m", min_length=3
    )


class Polyhedron(TurnedBody):
    """A closed convex polyhedron of a 3-D run."""

    only_dim: ClassVar[int | None] = 3
    is_solid: ClassVar[bool] = True

    shape: Literal["stl"]
    file: str = Field(description="path, relative to this scenario file")
    digest: Digest | None = Field(
        None, description="BLAKE2b of the file, 32 hexadecimal digits; another one is refused"
    )
    scale: Positive = Field(1.0, description="m per unit of the file")
    centre: Position | None = Field(
        None, description="where its centre of mass is put, m; default: where the file has it"
    )


class Points(ShapedBody):
    """Particles at given positions."""

    can_be_single: ClassVar[bool] = True
    must_be_single: ClassVar[bool] = True

    shape: Literal["points"]
    position: Annotated[list[Vector], Measured(LENGTH)] = Field(
        description="one vector per particle, m", min_length=1
    )
    mass: ParticleMass = Field(description="mass of each particle, kg (2-D: kg/m)")


class ParticleFile(BodyTable):
    """Particles read from a CSV or HDF5 file."""

    is_read: ClassVar[bool] = True

    shape: Literal["file"]
    file: str = Field(description="path, relative to this scenario file")
    digest: Digest | None = Field(
        None, description="BLAKE2b of the file, 32 hexadecimal digits; another one is refused"
    )
    fixed: bool = Field(False, description="where the file has no column `fixed`")
    material: OptionalMaterialName = Field(
        None, description="where the file has no column `material`"
    )


class Tank(WallKeys, BodyTable):
    """Fixed walls outside an inner box: a body NAME.-x, NAME.+x ... for each side."""

    shape: Literal["tank"]
    fixed: bool = Field(True, description="always true: it moves only as `motion` says")
    material: MaterialName = Field(description="name of its material")
    min: Position = Field(description="lower corner of the space inside, m")
    max: Position = Field(description="upper corner of the space inside, m")
    thickness: Length | None = Field(
        None, description="of the walls, m; default: as many layers as the kernel sees"
    )
    open: list[Side] | None = Field(
        None, description='sides without a wall, such as ["-x", "+y"]; default: the top'
    )
    motion: Motion | None = Field(None, description="prescribed motion")

    @model_validator(mode="after")
    def _has_room(self) -> Tank:
        if not self.fixed:
            raise ValueError("a tank is fixed")
        if not np.all(self.min < self.max):
            raise ValueError("every entry of min must be below that of max")
        return self


GRAINS = "grains"


def _packed(table: dict[str, Any]) -> str | None:
    """Discs and spheres with a diameter in place of a radius are grains."""
    is_ball = table.get("shape") in ("disc", "sphere")
    return GRAINS if is_ball and ("d" in table or "grading" in table) else None


BODIES = Kinds(
    "shape",
    ShapedBody,
    {
        "box": Box,
        "disc": Disc,
        "sphere": Disc,
        "polygon": Polygon,
        "stl": Polyhedron,
        "mesh": Mesh,
        "points": Points,
        "file": ParticleFile,
        "tank": Tank,
        "release": Release,
        GRAINS: Grains,
    },
    special=_packed,
)

if TYPE_CHECKING:
    AnyBody = BodyTable
else:
    AnyBody = BODIES.union
