"""The kinds of gauges: one line each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..table import Kinds
from .discharge import Discharge
from .gauge import Gauge
from .loads.approach import Approach
from .loads.force import Force
from .loads.load import Load
from .loads.overtopping import Overtopping
from .loads.panels import Panels
from .mass_centre import MassCentre
from .motion import Motion
from .pressure import PressureGauge
from .section import Section
from .surface_height import SurfaceHeight
from .velocity_profile import VelocityProfile

GAUGES = Kinds.by_word(
    "kind",
    Gauge,
    SurfaceHeight,
    VelocityProfile,
    PressureGauge,
    Discharge,
    Force,
    MassCentre,
    Motion,
    Section,
    Load,
    Panels,
    Approach,
    Overtopping,
)

if TYPE_CHECKING:
    GaugeTable = Gauge
else:
    GaugeTable = GAUGES.union
