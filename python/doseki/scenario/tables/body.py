"""[body.NAME]: what bodies of several shapes have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ..array import Array
from ..kinematics import BREAKABLE, ELASTIC, FIXED, PARTICLES, RIGID, SINGLE, Kinematics
from ..materials import ELASTIC_DEFAULTS, HYPERELASTIC_LAWS
from ..schemes import RESOLVED
from ..table import Only, Part
from ..values.types import (
    Angle,
    DisplacementField,
    Length,
    MaterialName,
    ParticleMass,
    Position,
    ScalarField,
    Spin,
    Vector,
    VelocityField,
)
from ..values.units import PRESSURE, Measured
from .motion import Motion
from .wall import OF_WALLS, WallKeys

if TYPE_CHECKING:
    ElasticLaw = str
else:
    ElasticLaw = Literal[tuple(HYPERELASTIC_LAWS)]


class BodyTable(Part):
    """What every table [body.NAME] has, and what its shape means for the checks of a scenario."""

    only_dim: ClassVar[int | None] = None  # of runs that have this shape; None: any
    is_solid: ClassVar[bool] = False  # a solid of the resolved scheme, made of bodies also if fixed
    can_be_single: ClassVar[bool] = False  # as one particle per body
    must_be_single: ClassVar[bool] = False
    is_read: ClassVar[bool] = False  # from a file of particles
    of_particles: ClassVar[tuple[str, ...]] = ()  # keys for particles that move by themselves

    shape: str
    fixed: bool
    material: str | None

    @property
    def described(self) -> str:
        """The keys that make it what it is, for messages."""
        return f'shape = "{self.shape}"'

    @property
    def prescribed_motion(self) -> Motion | None:
        """How a fixed body moves."""
        return None

    @property
    def smallest(self) -> float | None:
        """Diameter of the smallest of the balls that it is made of, m, if it is made of any."""
        return None

    def layers(self, dp: float) -> int | None:
        """Particles of spacing `dp`, m, across its thinnest side, if it has sides."""
        return None

    def kinematics_in(self, scheme: str, law: str | None) -> Kinematics:
        """How its particles move, in a scheme and with the law of its material."""
        return FIXED if self.fixed else PARTICLES


class ShapedBody(WallKeys, BodyTable):
    """What every body with a shape has."""

    of_particles: ClassVar[tuple[str, ...]] = ("pressure",)

    material: MaterialName = Field(description="name of its material")
    pressure: Annotated[ScalarField, Measured(PRESSURE)] | None = Field(
        None,
        description="initial pressure, Pa; a number or an expression of x, y, z; particles keep "
        "their volume",
    )
    fixed: bool = Field(False, description="true: interacts but moves only as `motion` says")
    array: Array | None = Field(None, description="copies; each is a body NAME.1, NAME.2 ...")
    motion: Annotated[Motion | None, Only(fixed=True)] = Field(
        None, description="prescribed motion of a fixed body"
    )
    velocity: VelocityField | None = Field(
        None, description="initial velocity, m/s; expressions may use x, y, z"
    )
    normal: Annotated[Vector | None, OF_WALLS] = Field(
        None,
        description="fixed, resolved scheme: direction into the fluid before rotation, of a whole "
        "box along an axis; default from the shape",
    )
    kinematics: Literal["rigid", "elastic", "breakable", "single"] | None = Field(
        None,
        description="free solids of the resolved scheme: rigid (the default), elastic, breakable: "
        "rigid until something strikes it so that it may break, or single: one particle per grain",
    )
    clamped: ScalarField | None = Field(
        None, description="elastic: points do not move where this expression of x, y, z is above 0"
    )
    displacement: DisplacementField | None = Field(
        None,
        description="elastic: where points start less where they are without stress, m; "
        "expressions of x, y, z there",
    )
    elastic_law: ElasticLaw | None = Field(
        None,
        description=f"elastic: law of stress; default {ELASTIC_DEFAULTS['elastic_law']}",
    )
    damping: float | None = Field(
        None,
        ge=0,
        le=1,
        description=f"elastic: viscosity over rho0 c_P dp; default {ELASTIC_DEFAULTS['damping']}",
    )
    hourglass: float | None = Field(
        None,
        ge=0,
        le=1,
        description="elastic: springs over the shear modulus; default "
        f"{ELASTIC_DEFAULTS['hourglass']}",
    )
    flaw_seed: int | None = Field(
        None,
        ge=0,
        lt=2**53,
        description='elastic, of a material with fracture = "grady_kipp": of its random flaws; '
        f"default {ELASTIC_DEFAULTS['flaw_seed']}",
    )
    spin: Spin | None = Field(
        None, description="free solids of the resolved scheme: initial rad/s; 3-D: a vector"
    )

    @property
    def prescribed_motion(self) -> Motion | None:
        """How a fixed body moves."""
        return self.motion

    def kinematics_in(self, scheme: str, law: str | None) -> Kinematics:
        """Solids of the resolved scheme move as bodies."""
        if self.fixed or scheme != RESOLVED or law != "solid":
            return super().kinematics_in(scheme, law)
        ways = {way.name: way for way in (ELASTIC, BREAKABLE, SINGLE)}
        return ways.get(self.kinematics or "", RIGID)


class TurnedBody(ShapedBody):
    """A body that can be rotated."""

    dp: Length | None = Field(None, description="particle spacing, m (default: the run's)")
    rotate: Angle = Field(
        0.0,
        description="degrees, from the first axis towards the last; turns its shape and `normal`: "
        "velocity, spin, motion and expressions of x, y, z are along the axes of the scene",
    )
    rotate_axis: Annotated[Vector | None, Only(dim=3)] = Field(
        None, description="3-D: axis of a right-handed rotation"
    )
    pivot: Position | None = Field(
        None,
        description="point about which it is rotated, m; default: `min` of a box, the centre of a "
        "disc, sphere or stl, the centre of mass of a polygon, the `position` of a mesh",
    )

    @model_validator(mode="after")
    def _turned(self) -> TurnedBody:
        for key in ("rotate_axis", "pivot"):
            if key in self.model_fields_set and "rotate" not in self.model_fields_set:
                raise ValueError(f"{key} goes with rotate, in degrees")
        return self


class LatticeBody(TurnedBody):
    """A body filled with particles on a lattice."""

    of_particles: ClassVar[tuple[str, ...]] = (
        "pressure",
        "jitter",
        "where",
        "mass_per_particle",
        "wetted_by",
        "count",
    )

    mass_per_particle: ParticleMass | None = Field(
        None, description="kg (2-D: kg/m); default rho0 dp^dim"
    )
    jitter: float = Field(
        0.0, ge=0, le=0.5, description="random displacement along each axis, in spacings"
    )
    random_seed: int = Field(1, ge=0, description="of the jitter")
    where: ScalarField | None = Field(
        None, description="expression of x, y, z; only particles where it is above zero are kept"
    )

    @model_validator(mode="after")
    def _seed_of_jitter(self) -> LatticeBody:
        if {"random_seed", "jitter"} & self.model_fields_set == {"random_seed"}:
            raise ValueError("random_seed goes with jitter")
        return self
