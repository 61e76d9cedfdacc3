"""One number that describes a material."""

from __future__ import annotations

from dataclasses import dataclass

LIMIT = 1e15  # of any parameter, in SI units: beyond it is a slip of the keyboard


@dataclass(frozen=True)
class MaterialParameter:
    """A number of a material: > above or >= least, < below or <= most."""

    name: str  # in scenarios and in the core
    unit: str
    doc: str
    above: float | None = None
    least: float | None = None
    below: float | None = LIMIT
    most: float | None = None
    default: float | None = None
    optional: bool = False  # else a new material must give what has no default
    law: str | None = None  # the only one it belongs to: "fluid" or "solid"
    scheme: str | None = None  # the only one that has it
