"""A whole scenario file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from ..gauges.kinds import GaugeTable
from ..materials import EQUATIONS_OF_STATE, laws_of
from ..schemes import RESOLVED, UETA2022
from ..table import Only, Table
from ..values.types import (
    Acceleration,
    Angle,
    Axis,
    Duration,
    Length,
    NonNegative,
    Position,
    Positive,
    Precision,
    Skin,
    Speed,
    Title,
)
from ..values.units import ACCELERATION, FREQUENCY, Measured
from .bodies import AnyBody
from .contact import Contact
from .figure import FigureTable
from .inflow import Inflow
from .material import MaterialTable
from .parameter import Parameter
from .region import Outflow, Window
from .start import Start
from .terrain.maps import Maps
from .terrain.terrain import Terrain

if TYPE_CHECKING:
    EquationOfState = str
else:
    EquationOfState = Literal[laws_of(EQUATIONS_OF_STATE, RESOLVED)]

OF_RESOLVED, OF_UETA2022 = Only(scheme=RESOLVED), Only(scheme=UETA2022)


class ScenarioTable(Table):
    """A whole scenario file, every expression evaluated."""

    schema_version: Literal[1] = Field(1, alias="schema", description="version of this format")
    title: Title = Field("", description="one line")
    description: str = Field("", description="what it is and where it comes from")
    dim: Literal[2, 3] = Field(description="number of space dimensions")
    dp: Length = Field(description="particle spacing, m")
    time_max: Duration = Field(description="end of the run, s")
    time_out: Duration = Field(description="time between snapshots, s")
    time_history: Duration | None = Field(None, description="s between history rows")
    scheme: Literal["ueta2022", "resolved"] = Field("ueta2022", description="the list of terms")
    kernel: Annotated[Literal["wendland_c2", "wendland_c6"], OF_RESOLVED] = Field(
        "wendland_c6", description="W; ueta2022 has wendland_c6 alone"
    )
    eos: Annotated[EquationOfState, OF_RESOLVED] = Field(
        "linear", description="resolved: law of pressure"
    )
    viscosity: Annotated[Literal["stress", "morris", "monaghan_cleary"] | None, OF_RESOLVED] = (
        Field(
            None,
            description="resolved: form of the viscous term, Eq. (28); default: stress, in runs "
            "with grains of mu(I), or of mud on a voellmy wall, morris",
        )
    )
    turbulence: Annotated[Literal["none", "smagorinsky", "mixing_length"], OF_RESOLVED] = Field(
        "none", description="resolved: eddy viscosity"
    )
    smagorinsky: Annotated[NonNegative, OF_RESOLVED] = Field(
        0.12, description="resolved: C_s of the eddy viscosity"
    )
    shifting: Annotated[bool, OF_RESOLVED] = Field(
        True, description="resolved: keep particles evenly spread"
    )
    acoustic_damping: Annotated[float, Field(ge=0, le=1), OF_RESOLVED] = Field(
        0.05, description="resolved: alpha_s of a bulk viscosity that damps sound"
    )
    relax: Annotated[Duration | None, OF_RESOLVED] = Field(
        None, description="resolved: s for which fluid comes to rest before the run begins"
    )
    uplift: Annotated[bool, OF_RESOLVED] = Field(
        True, description="resolved: water presses on bodies in gaps where no particle fits"
    )
    speed_max: Speed | None = Field(
        None, description="highest speed expected, m/s: sound speed 10 times that; excludes xi"
    )
    precision: Precision = Field(
        "double", description="of the pair arithmetic; mixed: single, of a state in double"
    )
    gravity: Acceleration | None = Field(None, description="m/s2; excludes slope")
    slope: Angle | None = Field(None, ge=-90, le=90, description="degrees; excludes gravity")
    g: Annotated[Positive, Measured(ACCELERATION)] = Field(
        9.8, description="gravity on a slope and in eq. 19, m/s2"
    )
    attraction: Annotated[NonNegative, Measured(FREQUENCY), OF_RESOLVED] = Field(
        0.0, description="resolved: B of a force -B^2 x per mass towards the origin, 1/s"
    )
    eta: float = Field(1.2, ge=0.8, le=3, description="smoothing length over spacing (eq. 10)")
    alpha: Annotated[NonNegative, OF_UETA2022] = Field(
        1.0, description="ueta2022: artificial viscosity (eq. 13)"
    )
    balsara: Annotated[bool, OF_UETA2022] = Field(True, description="ueta2022: Balsara switch")
    strength: Annotated[bool, OF_UETA2022] = Field(
        True, description="ueta2022: elastic deviatoric stress of solids"
    )
    tension: Annotated[Literal["free", "clamp_fluid", "clamp_all"], OF_UETA2022] = Field(
        "clamp_fluid", description="ueta2022: where negative pressure is set to zero"
    )
    h_mode: Annotated[Literal["constant", "eq10"], OF_UETA2022] = Field(
        "constant", description="ueta2022: smoothing length in time"
    )
    sym_grad: Annotated[bool, OF_UETA2022] = Field(
        False, description="ueta2022: mean kernel gradient also in eqs. 9 and 11"
    )
    cflnumber: float = Field(0.1, gt=0, le=1, description="C_CFL of eq. 18")
    cfl_force: float = Field(0.1, gt=0, le=1, description="C_f of eq. 18")
    xi: Positive | None = Field(None, description="reduction factor (eq. 19); excludes xi_height")
    xi_height: Length | None = Field(None, description="H of eq. 19, m; excludes xi")
    fixed_limits_dt: Annotated[bool, OF_UETA2022] = Field(
        True,
        description="ueta2022: false: in eq. 18 a fixed particle is no stiffer than what it meets",
    )
    skin: Skin = Field(0.05, description='margin of the lists over the support, or "auto"')
    periodic: list[Axis] = Field(default_factory=list, description="periodic axes")
    domain_min: Position | None = Field(None, description="lower corner of the periodic domain, m")
    domain_max: Position | None = Field(None, description="upper corner of the periodic domain, m")
    contact: Annotated[Contact, OF_RESOLVED] = Field(default_factory=Contact)
    terrain: Annotated[Terrain | None, OF_RESOLVED] = None
    start: Start | None = None
    maps: Annotated[Maps | None, Only(dim=3)] = None
    parameters: dict[str, Parameter] = Field(default_factory=dict)
    material: dict[str, MaterialTable] = Field(default_factory=dict)
    body: dict[str, AnyBody] = Field(default_factory=dict)
    inflow: dict[str, Inflow] = Field(default_factory=dict)
    outflow: dict[str, Outflow] = Field(default_factory=dict)
    gauge: dict[str, GaugeTable] = Field(default_factory=dict)
    window: dict[str, Window] = Field(default_factory=dict)
    figure: dict[str, FigureTable] = Field(default_factory=dict)
