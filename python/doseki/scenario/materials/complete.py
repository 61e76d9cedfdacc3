"""The materials of a scenario: its tables laid over the built-in ones, and checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from .laws import (
    EQUATIONS_OF_STATE,
    FRACTURES,
    NO_FRACTURE,
    RHEOLOGIES,
    Law,
    owners,
    parameters_of,
)
from .material import BUILT_IN, DEFAULTS, MATERIAL_PARAMETERS, Material
from .presets import without_preset

# m/s, of solids without one: beside fluids, only the speed at which a run is given up follows.
NOMINAL_SOUND = 3000.0


class MaterialError(ValueError):
    """A material table that cannot be completed; `material` is its name."""

    def __init__(self, material: str, message: str) -> None:
        super().__init__(message)
        self.material = material


def complete_materials(
    tables: Mapping[str, Mapping[str, Any]], eos: str | None = None
) -> dict[str, Material]:
    """The built-in materials with the scenario's tables laid over them.

    A table holds only given values: `law`, any of MATERIAL_PARAMETERS, and `based_on`, the name of
    the material that supplies the rest, or a preset with its keys.  `eos` is the equation of state
    of the run, where its parameters are to be checked.  Raises MaterialError when a value is
    missing or of no use.
    """
    names = [*BUILT_IN, *(name for name in tables if name not in BUILT_IN)]
    materials = {name: _complete(name, tables, ()) for name in names}
    for material in materials.values():
        objection = next(_objections(material, eos), None)
        if objection is not None:
            raise MaterialError(material.name, objection)
    return materials


def _complete(
    name: str, tables: Mapping[str, Mapping[str, Any]], waiting: tuple[str, ...]
) -> Material:
    """One material; `waiting` are the materials that are based on it."""
    try:
        table = without_preset(tables.get(name, {}))
    except ValueError as error:
        raise MaterialError(name, str(error)) from None
    base_name = table.pop("based_on", None)
    if base_name is None:
        return _over(BUILT_IN.get(name), name, table)
    if base_name not in tables and base_name not in BUILT_IN:
        known = ", ".join(sorted({*tables, *BUILT_IN} - {name}))
        raise MaterialError(name, f'based_on = "{base_name}" is not a material; known: {known}')
    if base_name in (name, *waiting):
        raise MaterialError(name, f'based_on = "{base_name}" leads back to the material itself')
    return _over(_complete(base_name, tables, (*waiting, name)), name, table)


def _over(base: Material | None, name: str, table: Mapping[str, Any]) -> Material:
    """The values of `table` laid over `base`, or over the defaults when there is no base."""
    if base is not None:
        return base.with_values({**table, "name": name})
    values = DEFAULTS | {"law": None} | dict(table)
    optional = {p.name for p in MATERIAL_PARAMETERS if p.optional}
    has_sound = values["law"] != "solid" or values["speedsound"] is not None
    if not has_sound:
        values["speedsound"] = NOMINAL_SOUND
    missing = [key for key, value in values.items() if value is None and key not in optional]
    if missing:
        raise MaterialError(
            name,
            f"a new material needs {', '.join(sorted(missing))}, or based_on = a known material",
        )
    needed = {key: values.pop(key) for key in ("rho0", "speedsound", "shear_modulus", "nu", "law")}
    return replace(Material(name=name, **needed).with_values(values), has_sound=has_sound)


def _objections(material: Material, eos: str | None) -> Iterator[str]:
    """What is wrong with a material whose numbers are right by themselves."""
    if material.law == "solid" and material.rheology != "newtonian":
        yield f'rheology = "{material.rheology}" is for fluids; this material is a solid'
    if material.law == "fluid" and material.fracture != NO_FRACTURE:
        yield f'fracture = "{material.fracture}" is for solids; this material is a fluid'
    values = material.table()
    for parameter in MATERIAL_PARAMETERS:
        given = values[parameter.name] not in (parameter.default, None)
        if given and parameter.law not in (None, material.law):
            yield f"{parameter.name} is for {parameter.law}s; this material is a {material.law}"
    yield from _objections_of_law(material, "rheology", RHEOLOGIES, material.rheology)
    yield from _objections_of_law(material, "fracture", FRACTURES, material.fracture)
    if eos is not None and material.law == "fluid":
        yield from _objections_of_law(material, "eos", EQUATIONS_OF_STATE, eos)
    if material.yield_strength > 0 and (material.cohesion > 0 or material.friction_angle > 0):
        yield "yield_strength excludes cohesion and friction_angle: give one or the others"


def _objections_of_law(
    material: Material, key: str, family: Mapping[str, Law], chosen: str
) -> Iterator[str]:
    """About the parameters of the laws of one family, of which the material has one."""
    for parameter in parameters_of([family]).values():
        names = owners(family, parameter)
        if material.of_laws[parameter.name] != parameter.default and chosen not in names:
            allowed = " or ".join(f'"{name}"' for name in names)
            yield f'{parameter.name} is for {key} = {allowed}; this material is "{chosen}"'
    for name in family[chosen].needed:
        if material.of_laws[name] <= 0:
            yield f'{key} = "{chosen}" needs {name}, greater than 0'
    objection = family[chosen].objection(material.of_laws)
    if objection is not None:
        yield objection
