"""Materials: the parameters, declared once, and the built-in table of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

LAWS = ("fluid", "solid")
LIMIT = 1e15  # of any parameter, in SI units: beyond it is a slip of the keyboard


@dataclass(frozen=True)
class MaterialParameter:
    """One number that describes a material: > above, or >= least; always < LIMIT."""

    name: str
    unit: str
    doc: str
    above: float | None = None
    least: float | None = None
    default: float | None = None  # None: a new material must give it


MATERIAL_PARAMETERS = (
    MaterialParameter("rho0", "kg/m3", "reference density", above=0.0),
    MaterialParameter("speedsound", "m/s", "sound speed at the reference density", above=0.0),
    MaterialParameter("shear_modulus", "Pa", "shear modulus (solids)", least=0.0, default=0.0),
    MaterialParameter("nu", "m2/s", "kinematic viscosity (fluids)", least=0.0, default=0.0),
)


@dataclass(frozen=True)
class Material:
    """A material with the values of the laboratory, not yet scaled by xi.

    `law` says how stress follows from motion: "fluid" (viscous, eqs. 6-7) or "solid" (elastic,
    eqs. 3-5).  The numbers are those of MATERIAL_PARAMETERS, in their units.
    """

    name: str
    law: str
    rho0: float
    speedsound: float
    shear_modulus: float
    nu: float

    def scaled(self, xi: float) -> Material:
        """The material of a run with reduced sound speed: c0 -> xi c0, mu -> xi^2 mu (eq. 19)."""
        return replace(
            self, speedsound=xi * self.speedsound, shear_modulus=xi**2 * self.shear_modulus
        )


# Table 1 of the paper; the viscosity of water is given under eq. 7.
BUILT_IN = {
    "water": Material("water", "fluid", 1000.0, 1400.0, 0.0, 1e-6),
    "basalt": Material("basalt", "solid", 2750.0, 3116.0, 22.7e9, 0.0),
    "aluminium": Material("aluminium", "solid", 2700.0, 5277.0, 25.5e9, 0.0),
}


class MaterialError(ValueError):
    """A material table that cannot be completed; `material` is its name."""

    def __init__(self, material: str, message: str) -> None:
        super().__init__(message)
        self.material = material


def complete_materials(tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Material]:
    """The built-in materials with the scenario's tables laid over them.

    A table holds only given values: `law`, any of MATERIAL_PARAMETERS, and `based_on`, the name of
    the material that supplies the rest.  Raises MaterialError when a value is missing.
    """
    names = [*BUILT_IN, *(name for name in tables if name not in BUILT_IN)]
    return {name: _complete(name, tables, ()) for name in names}


def _complete(
    name: str, tables: Mapping[str, Mapping[str, Any]], waiting: tuple[str, ...]
) -> Material:
    """One material; `waiting` are the materials that are based on it."""
    table = dict(tables.get(name, {}))
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
        return replace(base, name=name, **table)
    values = {p.name: p.default for p in MATERIAL_PARAMETERS} | {"law": None} | dict(table)
    missing = [key for key, value in values.items() if value is None]
    if missing:
        raise MaterialError(
            name,
            f"a new material needs {', '.join(sorted(missing))}, or based_on = a known material",
        )
    return Material(name=name, **values)
