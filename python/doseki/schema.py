"""The tables of a scenario file: keys, types, units and bounds, each declared once."""

from __future__ import annotations

import sys
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    create_model,
    model_validator,
)

from .materials import LAWS, MATERIAL_PARAMETERS, RHEOLOGIES, MaterialParameter
from .value_types import (
    Axis,
    Corner,
    Depth,
    Grading,
    Hydrograph,
    Length,
    Mass,
    NonNegative,
    Positive,
    Rate,
    ScalarField,
    Skin,
    Vector,
    VelocityField,
)


class Table(BaseModel):
    """A table of a scenario file: no unknown key, no silent conversion, finite numbers."""

    model_config = ConfigDict(
        extra="forbid", strict=True, allow_inf_nan=False, arbitrary_types_allowed=True
    )


class Part(Table):
    """A named table that can be switched off."""

    enabled: bool = Field(True, description="false: as if the table were not there")


class Parameter(Table):
    """A number or word of the scenario itself, to be set by name and used in expressions."""

    value: Any = Field(description="a number, true/false or a word")
    min: float | None = Field(None, description="least allowed value")
    max: float | None = Field(None, description="greatest allowed value")
    choices: list[Any] | None = Field(None, description="the allowed values")
    unit: str = Field("", description="unit of the value")
    help: str = Field("", description="what it is")

    @model_validator(mode="after")
    def _allowed(self) -> Parameter:
        value = self.value
        if not isinstance(value, int | float | str):
            raise ValueError("must be a number, true/false or a word")
        if self.choices is not None and value not in self.choices:
            raise ValueError(f"{value!r} is not one of {', '.join(map(str, self.choices))}")
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if number and not abs(value) <= sys.float_info.max:
            raise ValueError("must be finite")
        if (self.min is not None or self.max is not None) and not number:
            raise ValueError(f"must be a number, not {value!r}")
        if self.min is not None and value < self.min:
            raise ValueError(f"{value!r} is out of range; must be {self.min:g} {self.unit} or more")
        if self.max is not None and value > self.max:
            raise ValueError(f"{value!r} is out of range; must be {self.max:g} {self.unit} or less")
        return self


def _material_field(parameter: MaterialParameter) -> tuple[Any, Any]:
    description = f"{parameter.doc}, {parameter.unit}".removesuffix(", ")
    return (
        float | None,
        Field(
            None,
            gt=parameter.above,
            ge=parameter.least,
            lt=parameter.below,
            le=parameter.most,
            description=description,
        ),
    )


MaterialTable = create_model(
    "MaterialTable",
    __base__=Table,
    law=(Literal[LAWS] | None, Field(None, description="how stress follows from motion")),
    rheology=(
        Literal[RHEOLOGIES] | None,
        Field(None, description="how a fluid's viscosity follows"),
    ),
    based_on=(str | None, Field(None, description="material that supplies what is not given")),
    **{parameter.name: _material_field(parameter) for parameter in MATERIAL_PARAMETERS},
)


class Motion(Table):
    """A prescribed motion of a fixed body."""

    velocity: Vector | None = Field(None, description="m/s; default: none")
    angular_velocity: float | Vector | None = Field(
        None, description="rad/s, anticlockwise; 3-D: a vector; default: none"
    )
    pivot: Vector | None = Field(
        None, description="point about which it turns, which goes with it, m"
    )
    start: NonNegative = Field(0.0, description="when it begins to move, s")
    stop: Positive | None = Field(None, description="when it stands still again, s")
    removed_at: Positive | None = Field(None, description="when the body vanishes, s")

    @model_validator(mode="after")
    def _fits_together(self) -> Motion:
        if self.stop is not None and self.stop <= self.start:
            raise ValueError(f"stop = {self.stop:g} s must be later than start = {self.start:g} s")
        if self.angular_velocity is not None and self.pivot is None:
            raise ValueError("angular_velocity needs a pivot, the point about which the body turns")
        if self.velocity is None and self.angular_velocity is None and self.removed_at is None:
            raise ValueError("give velocity, angular_velocity or removed_at")
        return self


class ShapedBody(Part):
    """What every body with a shape has."""

    material: str = Field(description="name of its material")
    pressure: ScalarField | None = Field(
        None,
        description="initial pressure, Pa; a number or an expression of x, y, z; particles keep "
        "their volume",
    )
    fixed: bool = Field(False, description="true: interacts but moves only as `motion` says")
    motion: Motion | None = Field(None, description="prescribed motion of a fixed body")
    velocity: VelocityField | None = Field(
        None, description="initial velocity, m/s; expressions may use x, y, z"
    )
    wall: Literal["no_slip", "free_slip", "rough"] = Field(
        "no_slip", description="fixed, resolved scheme: how fluid meets it"
    )
    ks: Length | None = Field(None, description="rough wall: equivalent sand roughness, m")
    normal: Vector | None = Field(
        None, description="fixed, resolved scheme: direction into the fluid; default from the shape"
    )
    kinematics: Literal["rigid", "elastic", "single"] | None = Field(
        None,
        description="free solids of the resolved scheme: rigid (the default), elastic, or single: "
        "one particle per grain",
    )
    clamped: ScalarField | None = Field(
        None, description="elastic: points do not move where this expression of x, y, z is above 0"
    )
    elastic_law: Literal["st_venant_kirchhoff", "neo_hookean"] | None = Field(
        None, description="elastic: law of stress; default st_venant_kirchhoff"
    )
    damping: float | None = Field(
        None, ge=0, le=1, description="elastic: viscosity over rho0 c_P dp; default 0.02"
    )
    hourglass: float | None = Field(
        None, ge=0, le=1, description="elastic: springs over the shear modulus; default 0.5"
    )
    spin: float | Vector | None = Field(
        None, description="free solids of the resolved scheme: initial rad/s; 3-D: a vector"
    )


class TurnedBody(ShapedBody):
    """A body that can be rotated."""

    dp: Length | None = Field(None, description="particle spacing, m (default: the run's)")
    rotate: float = Field(0.0, description="degrees, from the first axis towards the last")
    rotate_axis: Vector | None = Field(None, description="3-D: axis of a right-handed rotation")
    pivot: Vector | None = Field(None, description="point about which it is rotated, m")


class LatticeBody(TurnedBody):
    """A body filled with particles on a lattice."""

    mass_per_particle: Positive | None = Field(None, description="kg; default rho0 dp^dim")
    jitter: float = Field(
        0.0, ge=0, le=0.5, description="random displacement along each axis, in spacings"
    )
    random_seed: int = Field(1, ge=0, description="of the jitter")
    where: ScalarField | None = Field(
        None, description="expression of x, y, z; only particles where it is above zero are kept"
    )


class Box(LatticeBody):
    """Particles at min + (k + 1/2) dp, round(length/dp) of them along each side."""

    shape: Literal["box"]
    min: Vector = Field(description="lower corner before rotation, m")
    max: Vector = Field(description="upper corner before rotation, m")
    count: int | None = Field(
        None, gt=0, description="keep this many particles, filled row by row from below"
    )
    wetted_by: str | None = Field(
        None,
        description="material that lies on its top at rest: the density is such that the cover "
        "brings it to rho0; else whatever comes to a dry bed hovers one support above it",
    )

    @model_validator(mode="after")
    def _wetted_whole(self) -> Box:
        if self.wetted_by is not None and self.where is not None:
            raise ValueError("wetted_by and where exclude each other: a wetted box is whole")
        return self


class Disc(LatticeBody):
    """A disc (2-D) or sphere (3-D) on a lattice centred on a particle, or one single particle."""

    shape: Literal["disc", "sphere"]
    centre: Vector = Field(description="its centre, m")
    radius: Length = Field(description="its radius, m")
    fill: Literal["lattice", "single"] = Field(
        "lattice", description="lattice: particles nearer than radius; single: one with its mass"
    )


class Grains(TurnedBody):
    """Discs (2-D) or spheres (3-D) packed at random into a box, from its bottom upwards."""

    shape: Literal["disc", "sphere"]
    min: Vector = Field(description="lower corner of the box before rotation, m")
    max: Vector = Field(description="upper corner of the box before rotation, m")
    d: Length | None = Field(None, description="diameter, m; excludes grading")
    grading: Grading | None = Field(
        None, description="[[d, share], ...] in m and parts of the mass; excludes d"
    )
    count: int | None = Field(None, gt=0, description="number of grains; excludes mass_total")
    mass_total: Mass | None = Field(
        None, description='kg or a string such as "20 kg"; default: what fills the box'
    )
    width: Length = Field(1.0, description="2-D: m; mass_total is that of a slice so wide")
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
    settle: bool | Positive = Field(
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
        if not np.all(self.min < self.max):
            raise ValueError("every entry of min must be below that of max")
        return self


class Polygon(TurnedBody):
    """A convex polygon of a 2-D run."""

    shape: Literal["polygon"]
    vertices: list[Vector] = Field(description="its corners in order, m", min_length=3)


class Mesh(TurnedBody):
    """A closed convex polyhedron of a 3-D run."""

    shape: Literal["stl"]
    file: str = Field(description="path, relative to this scenario file")
    scale: Positive = Field(1.0, description="m per unit of the file")
    centre: Vector | None = Field(
        None, description="where its centre of mass is put, m; default: where the file has it"
    )


class Points(ShapedBody):
    """Particles at given positions."""

    shape: Literal["points"]
    position: list[Vector] = Field(description="one vector per particle, m", min_length=1)
    mass: Positive = Field(description="mass of each particle, kg (2-D: kg/m)")


class ParticleFile(Part):
    """Particles read from a CSV or HDF5 file."""

    shape: Literal["file"]
    file: str = Field(description="path, relative to this scenario file")
    fixed: bool = Field(False, description="where the file has no column `fixed`")
    material: str | None = Field(None, description="where the file has no column `material`")


GRAINS = "grains"  # no word of a scenario: discs and spheres with a diameter in place of a radius
BODY_TABLES = {
    "box": Box,
    "disc": Disc,
    "sphere": Disc,
    "polygon": Polygon,
    "stl": Mesh,
    "points": Points,
    "file": ParticleFile,
    GRAINS: Grains,
}


def body_kind(table: Any) -> Any:
    """The key in BODY_TABLES of a table [body.NAME], or whatever it says its shape is."""
    if not isinstance(table, dict):
        return GRAINS if isinstance(table, Grains) else getattr(table, "shape", None)
    shape = table.get("shape")
    packed = shape in ("disc", "sphere") and ("d" in table or "grading" in table)
    return GRAINS if packed else shape


BodyTable = Annotated[
    Annotated[Box, Tag("box")]
    | Annotated[Disc, Tag("disc")]
    | Annotated[Disc, Tag("sphere")]
    | Annotated[Polygon, Tag("polygon")]
    | Annotated[Mesh, Tag("stl")]
    | Annotated[Points, Tag("points")]
    | Annotated[ParticleFile, Tag("file")]
    | Annotated[Grains, Tag(GRAINS)],
    Discriminator(body_kind),
]


class Inflow(Part):
    """A section through which particles enter, at a constant rate or as a hydrograph says."""

    material: str = Field(description="name of the material that enters")
    rate: Rate | None = Field(None, description='m3/s, or a string such as "3 L/s"')
    hydrograph: Hydrograph | None = Field(
        None,
        description="[[t, Q], ...] in s after `start` and m3/s, or a CSV file with columns t and"
        " Q; excludes rate",
    )
    width: Length = Field(description="m; a 2-D run enters rate/width")
    position: Vector = Field(description="bottom point of the section, m")
    direction: Vector = Field(description="direction of the flow")
    depth: Depth = Field(
        description='m, extent along the section\'s upward normal, or "normal": of uniform flow'
    )
    ks: Length | None = Field(None, description="roughness of the bed in the normal depth, m")
    start: NonNegative = Field(0.0, description="s")
    duration: Positive | None = Field(None, description="s; a hydrograph has its own")
    jitter: float = Field(
        0.0, ge=0, lt=0.5, description="random displacement along each axis, in spacings"
    )

    @model_validator(mode="after")
    def _has_direction(self) -> Inflow:
        if not np.any(self.direction):
            raise ValueError("direction must not be the zero vector")
        return self

    @property
    def rows(self) -> np.ndarray:
        """Rows (n, 2) of time, s, and discharge, m3/s; linear in between."""
        given = self.hydrograph or [[0.0, self.rate], [self.duration, self.rate]]
        return np.array(given, dtype=float) + np.array([self.start, 0.0])

    @property
    def peak_rate(self) -> float:
        """Largest discharge, m3/s."""
        return float(self.rows[:, 1].max())


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


class Window(Region):
    """A region that figures and histograms look at."""

    title: str = Field("", description="caption")
    rotate: float = Field(
        0.0, description="degrees about the origin, from the first axis towards the last"
    )


class Gauge(Part):
    """An instrument that is read at times of its own."""

    interval: Positive | None = Field(None, description="s between samples; default: time_out")


class FlowGauge(Gauge):
    """One that looks at what moves near a point."""

    position: Vector = Field(description="where it stands, m")
    material: str | None = Field(
        None, description="look only at this material; default: all that moves"
    )


class SurfaceHeight(FlowGauge):
    """Height of the column that stands on a point of the bed."""

    kind: Literal["surface_height"]
    direction: Vector | None = Field(None, description="upwards; default: against gravity")


class VelocityProfile(FlowGauge):
    """Velocity at points along a line from the bed."""

    kind: Literal["velocity_profile"]
    direction: Vector | None = Field(None, description="of the line; default: against gravity")
    length: Length = Field(description="of the line, m")
    count: int = Field(20, gt=0, le=10_000, description="points, at (k + 1/2) length/count")


class PressureGauge(FlowGauge):
    """Mean pressure of what is near a point of a wall."""

    kind: Literal["pressure"]
    radius: Length | None = Field(None, description="of the mean, m; default: 3 dp")


class Discharge(FlowGauge):
    """What flows through a section."""

    kind: Literal["discharge"]
    direction: Vector = Field(description="normal of the section, along which flow counts")
    depth: Length | None = Field(
        None, description="extent upwards from the position, m; default: everything"
    )
    width: Length | None = Field(None, description="3-D: extent across, m; default: everything")
    length: Length | None = Field(
        None, description="of the slab around the section, m; default: 4 dp"
    )


class ForceGauge(Gauge):
    """Force and moment of the flow on fixed bodies."""

    kind: Literal["force"]
    bodies: list[str] = Field(description="names of fixed bodies", min_length=1)
    about: Vector | None = Field(None, description="point of the moment, m; default: the origin")


GaugeTable = Annotated[
    SurfaceHeight | VelocityProfile | PressureGauge | Discharge | ForceGauge,
    Field(discriminator="kind"),
]
GAUGE_TABLES = {
    "surface_height": SurfaceHeight,
    "velocity_profile": VelocityProfile,
    "pressure": PressureGauge,
    "discharge": Discharge,
    "force": ForceGauge,
}


class Figure(Part):
    """A picture made from the record of a run."""

    kind: Literal["snapshot", "histogram", "series", "gauge"] = Field(description="what is drawn")
    title: str = Field("", description="caption")
    window: str | None = Field(None, description="name of a [window.NAME]; default: everything")
    times: list[float] = Field(
        default_factory=list, description="s; nearest snapshots; default: see `when`"
    )
    when: Literal["all", "first", "last", "before_flow", "with_flow"] = Field(
        "last",
        description="which snapshots, where no times are given: before_flow is the last one with "
        "no fluid in the window, with_flow the first one with fluid across all of it",
    )
    colour: list[str] = Field(
        default_factory=lambda: ["material"],
        description="one panel each: material, body, speed, velocity_x, pressure, density ...",
    )
    material: str | None = Field(None, description="count or draw only this material")
    bin_width: Positive = Field(0.1, description="histogram bins, m/s")
    sample: int = Field(30, gt=0, description="size of a random sample of particles")
    columns: list[str] = Field(
        default_factory=list, description="series, gauge: columns of the history, of the gauge"
    )
    gauge: str | None = Field(None, description="gauge: name of a [gauge.NAME]")


class Contact(Table):
    """How bodies touch: resolved scheme."""

    law: Literal["linear", "hertz"] = Field("linear", description="normal force")
    overlap: float = Field(
        0.01, gt=0, le=0.1, description="largest overlap over the diameter, for softened contacts"
    )
    speed: Positive | None = Field(
        None, description="largest speed of approach, m/s; default: speed_max"
    )
    stiffness: Literal["softened", "material"] = Field(
        "softened", description="softened: so that `overlap` holds; material: of Young's modulus"
    )
    steps: int = Field(20, ge=5, le=1000, description="time steps in a contact")


class ScenarioTable(Table):
    """A whole scenario file, every expression evaluated."""

    schema_version: Literal[1] = Field(1, alias="schema", description="version of this format")
    title: str = Field("", description="one line")
    description: str = Field("", description="what it is and where it comes from")
    dim: Literal[2, 3] = Field(description="number of space dimensions")
    dp: Length = Field(description="particle spacing, m")
    time_max: Positive = Field(description="end of the run, s")
    time_out: Positive = Field(description="time between snapshots, s")
    time_history: Positive | None = Field(None, description="s between history rows")
    scheme: Literal["ueta2022", "resolved"] = Field("ueta2022", description="the list of terms")
    kernel: Literal["wendland_c2", "wendland_c6"] = Field(
        "wendland_c6", description="W; the resolved scheme has wendland_c2 by default"
    )
    eos: Literal["linear", "tait"] = Field("linear", description="resolved: law of pressure")
    viscosity: Literal["morris", "monaghan_cleary"] = Field(
        "morris",
        description="resolved: form of the viscous term; the second keeps angular momentum",
    )
    turbulence: Literal["none", "smagorinsky", "mixing_length"] = Field(
        "none", description="resolved: eddy viscosity"
    )
    smagorinsky: NonNegative = Field(0.12, description="resolved: C_s of the eddy viscosity")
    shifting: bool = Field(True, description="resolved: keep particles evenly spread")
    speed_max: Positive | None = Field(
        None, description="highest speed expected, m/s: sound speed 10 times that; excludes xi"
    )
    precision: Literal["double", "float"] = Field("double", description="of the pair arithmetic")
    gravity: Vector | None = Field(None, description="m/s2; excludes slope")
    slope: float | None = Field(None, ge=-90, le=90, description="degrees; excludes gravity")
    g: Positive = Field(9.8, description="gravity on a slope and in eq. 19, m/s2")
    attraction: NonNegative = Field(
        0.0, description="resolved: B of a force -B^2 x per mass towards the origin, 1/s"
    )
    eta: float = Field(1.2, ge=0.8, le=3, description="smoothing length over spacing (eq. 10)")
    alpha: NonNegative = Field(1.0, description="artificial viscosity (eq. 13)")
    balsara: bool = Field(True, description="Balsara switch")
    strength: bool = Field(True, description="elastic deviatoric stress of solids")
    tension: Literal["free", "clamp_fluid", "clamp_all"] = Field(
        "clamp_fluid", description="where negative pressure is set to zero"
    )
    h_mode: Literal["constant", "eq10"] = Field("constant", description="smoothing length in time")
    sym_grad: bool = Field(False, description="mean kernel gradient also in eqs. 9 and 11")
    cflnumber: float = Field(0.1, gt=0, le=1, description="C_CFL of eq. 18")
    cfl_force: float = Field(0.1, gt=0, le=1, description="C_f of eq. 18")
    xi: Positive | None = Field(None, description="reduction factor (eq. 19); excludes xi_height")
    xi_height: Length | None = Field(None, description="H of eq. 19, m; excludes xi")
    fixed_limits_dt: bool = Field(
        True, description="false: in eq. 18 a fixed particle is no stiffer than what it meets"
    )
    skin: Skin = Field(0.05, description='margin of the lists over the support, or "auto"')
    periodic: list[Axis] = Field(default_factory=list, description="periodic axes")
    domain_min: Vector | None = Field(None, description="lower corner of the periodic domain, m")
    domain_max: Vector | None = Field(None, description="upper corner of the periodic domain, m")
    contact: Contact = Field(default_factory=Contact)
    parameters: dict[str, Parameter] = Field(default_factory=dict)
    material: dict[str, MaterialTable] = Field(default_factory=dict)
    body: dict[str, BodyTable] = Field(default_factory=dict)
    inflow: dict[str, Inflow] = Field(default_factory=dict)
    outflow: dict[str, Outflow] = Field(default_factory=dict)
    gauge: dict[str, GaugeTable] = Field(default_factory=dict)
    window: dict[str, Window] = Field(default_factory=dict)
    figure: dict[str, Figure] = Field(default_factory=dict)


TOP_LEVEL_KEYS = {field.alias or name for name, field in ScenarioTable.model_fields.items()}
ALIASES = {"hdp": "eta"}  # names people already type
EXCLUSIVE = (
    ("gravity", "slope"),
    ("xi", "xi_height"),
    ("xi", "speed_max"),
    ("xi_height", "speed_max"),
)
SECTIONS = {
    "parameters": Parameter,
    "material": MaterialTable,
    "body": None,  # its keys depend on the shape
    "inflow": Inflow,
    "outflow": Outflow,
    "gauge": None,  # its keys depend on the kind
    "window": Window,
    "figure": Figure,
}


SINGLE_TABLES = {"contact": Contact}  # of which a scenario has one
KINDS = {  # sections of several kinds of tables: the key that tells, the kinds, what all have
    "body": ("shape", BODY_TABLES, ShapedBody),
    "gauge": ("kind", GAUGE_TABLES, Gauge),
}


def table_at(keys: tuple[str | int, ...], table: Any) -> type[Table] | None:
    """The kind of table that stands at `keys` (top level: empty) of the scenario `table`."""
    if not keys:
        return ScenarioTable
    if len(keys) == 1 and keys[0] in SINGLE_TABLES:
        return SINGLE_TABLES[str(keys[0])]
    if len(keys) == 3 and keys[0] == "body" and keys[2] == "motion":
        return Motion
    if len(keys) != 2 or keys[0] not in SECTIONS:
        return None
    if keys[0] not in KINDS:
        return SECTIONS[str(keys[0])]
    tag, kinds, general = KINDS[str(keys[0])]
    try:
        part = table[keys[0]][keys[1]]
        return kinds.get(body_kind(part) if keys[0] == "body" else part[tag], general)
    except (KeyError, TypeError):
        return general
