"""[material.NAME]: the parameters of a material."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from ..materials import (
    FRACTURES,
    LAWS,
    MATERIAL_PARAMETERS,
    PRESETS,
    RHEOLOGIES,
    SOILS,
    MaterialParameter,
)
from ..schemes import RESOLVED
from ..table import Only, Table
from ..values.units import DENSITY, Measured, unit_named


def _material_field(parameter: MaterialParameter) -> tuple[Any, Any]:
    description = f"{parameter.doc}, {parameter.unit}".removesuffix(", ")
    unit = unit_named(parameter.unit)
    number = float if unit is None else Annotated[float, Measured(unit)]
    return (
        Annotated[number | None, Only(scheme=parameter.scheme)],
        Field(
            None,
            gt=parameter.above,
            ge=parameter.least,
            lt=parameter.below,
            le=parameter.most,
            description=description,
        ),
    )


_FIELDS: dict[str, Any] = {
    "law": (Literal[LAWS] | None, Field(None, description="how stress follows from motion")),
    "rheology": (
        Literal[tuple(RHEOLOGIES)] | None,
        Field(None, description="how a fluid's viscosity follows"),
    ),
    "fracture": (
        Annotated[Literal[tuple(FRACTURES)] | None, Only(scheme=RESOLVED)],
        Field(None, description="how the bodies of a solid break that are elastic; default none"),
    ),
    "preset": (
        Literal[tuple(PRESETS)] | None,
        Field(None, description="published material that supplies what is not given"),
    ),
    "soil": (
        Literal[tuple(SOILS)] | None,
        Field(None, description="sample of mud (obrien_julien)"),
    ),
    "cv": (
        float | None,
        Field(None, gt=0, lt=1, description="volume of sediment over all of it (obrien_julien)"),
    ),
    "solid_density": (
        Annotated[float | None, Measured(DENSITY)],
        Field(None, gt=0, lt=1e15, description="of the sediment, kg/m3 (obrien_julien; 2650)"),
    ),
    "based_on": (str | None, Field(None, description="material that supplies what is not given")),
} | {parameter.name: _material_field(parameter) for parameter in MATERIAL_PARAMETERS}

MaterialTable = create_model("MaterialTable", __base__=Table, **_FIELDS)
