"""[contact]: how bodies touch."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..table import Table
from ..values.types import Speed


class Contact(Table):
    """How bodies touch: resolved scheme."""

    law: Literal["linear", "hertz"] = Field("linear", description="normal force")
    overlap: float = Field(
        0.01, gt=0, le=0.1, description="largest overlap over the diameter, for softened contacts"
    )
    speed: Speed | None = Field(
        None, description="largest speed of approach, m/s; default: speed_max"
    )
    stiffness: Literal["softened", "material"] = Field(
        "softened", description="softened: so that `overlap` holds; material: of Young's modulus"
    )
    steps: int | None = Field(
        None,
        ge=5,
        le=1000,
        description="time steps in a contact; default: 12, with breakable bodies 20",
    )
