"""How fluid meets a wall: keys of whatever is fixed."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ..schemes import RESOLVED
from ..table import Only, Table
from ..values.types import Length, NonNegative, Positive
from ..values.units import ACCELERATION, Measured

OF_WALLS = Only(scheme=RESOLVED, fixed=True)
# The kind of wall that each key of friction goes with.
FRICTION_OF = {"ks": "rough", "mu": "voellmy", "turbulent_xi": "voellmy"}


class WallKeys(Table):
    """The keys by which a table says how fluid meets it."""

    needed_by_wall: ClassVar[dict[str, tuple[str, str]]] = {  # the key, and what it is
        "rough": ("ks", "a rough wall needs ks (m)"),
        "voellmy": ("mu", "a voellmy wall needs mu (coefficient of friction)"),
    }

    wall: Annotated[Literal["no_slip", "free_slip", "rough", "voellmy"], OF_WALLS] = Field(
        "no_slip", description="fixed, resolved scheme: how fluid meets it"
    )
    ks: Annotated[Length | None, OF_WALLS] = Field(
        None, description="rough wall: equivalent sand roughness, m"
    )
    mu: Annotated[NonNegative | None, OF_WALLS] = Field(
        None, description="voellmy wall: coefficient of friction"
    )
    turbulent_xi: Annotated[Positive | None, Measured(ACCELERATION), OF_WALLS] = Field(
        None, description="voellmy wall: turbulent coefficient, m/s2; default: no such friction"
    )

    @model_validator(mode="after")
    def _friction_of_its_wall(self) -> WallKeys:
        for key, wall in FRICTION_OF.items():
            if getattr(self, key) is None or self.wall == wall:
                continue
            # A rough wall may be made another by `--set` without that its roughness is removed.
            if key != "ks" or "wall" not in self.model_fields_set or self.wall == "voellmy":
                raise ValueError(f'{key} goes with wall = "{wall}"')
        return self
