"""`array` of a part: copies of it."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from .table import Table
from .values.types import Angle, Axis, Coordinate, Position, dimension
from .values.units import LENGTH, Measured

WAYS = ("count", "file", "turns", "mirror")
MAX_COPIES = 10_000


def _one_per_axis(counts: list[int], info: ValidationInfo) -> list[int]:
    if len(counts) != dimension(info) or any(count < 1 for count in counts):
        raise ValueError(f"give {dimension(info)} whole numbers from 1 on, one for each axis")
    return counts


class Array(Table):
    """Copies of a part: on a lattice, where a file says, turned about a point, or mirrored."""

    count: Annotated[list[int], AfterValidator(_one_per_axis)] | None = Field(
        None, description="copies along each axis, the part itself among them"
    )
    step: Position | None = Field(None, description="with count: from one to the next, m")
    stagger: Position | None = Field(
        None, description="with count: every second row along the last axis is moved by it, m"
    )
    file: str | None = Field(
        None, description="CSV file with columns x, y(, z), m, and angle, degrees: a copy each"
    )
    turns: int | None = Field(
        None, gt=1, description="copies around a point, the part itself among them"
    )
    about: Position | None = Field(None, description="with turns: that point, m")
    angle: Angle | None = Field(
        None, description="with turns: degrees from one to the next; default: all around"
    )
    mirror: Axis | None = Field(None, description="axis across which there is a mirrored copy")
    at: Annotated[Coordinate, Measured(LENGTH)] | None = Field(
        None, description="with mirror: where on the axis the mirror is, m"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Array:
        given = [key for key in WAYS if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(f"give one of {', '.join(WAYS)}")
        goes_with = {"step": "count", "stagger": "count", "about": "turns", "angle": "turns"}
        for key, other in (goes_with | {"at": "mirror"}).items():
            if getattr(self, key) is not None and other not in given:
                raise ValueError(f"{key} goes with {other}")
        for key, other in (("step", "count"), ("about", "turns"), ("at", "mirror")):
            if getattr(self, key) is None and other in given:
                raise ValueError(f"{other} goes with {key}, which is missing")
        return self
