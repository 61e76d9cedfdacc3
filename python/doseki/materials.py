"""Materials: the parameters, declared once, and the built-in table of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

LAWS = ("fluid", "solid")
HERSCHEL_BULKLEY, MU_I = "herschel_bulkley", "mu_i"
RHEOLOGIES = ("newtonian", HERSCHEL_BULKLEY, MU_I)
LIMIT = 1e15  # of any parameter, in SI units: beyond it is a slip of the keyboard


@dataclass(frozen=True)
class MaterialParameter:
    """One number that describes a material: > above, or >= least; always < below."""

    name: str
    unit: str
    doc: str
    above: float | None = None
    least: float | None = None
    below: float = LIMIT
    default: float | None = None  # None: a new material must give it
    law: str | None = None  # the only one it belongs to
    rheologies: tuple[str, ...] = ()  # those it belongs to; none: any


def _strength(name: str, unit: str, doc: str, below: float = LIMIT) -> MaterialParameter:
    return MaterialParameter(name, unit, doc, least=0.0, below=below, default=0.0, law="solid")


def _rheology(
    name: str, unit: str, doc: str, *rheologies: str, default: float = 0.0
) -> MaterialParameter:
    doc += f" ({', '.join(rheologies)})"
    return MaterialParameter(
        name, unit, doc, least=0.0, default=default, law="fluid", rheologies=rheologies
    )


MATERIAL_PARAMETERS = (
    MaterialParameter("rho0", "kg/m3", "reference density", above=0.0),
    MaterialParameter("speedsound", "m/s", "sound speed at the reference density", above=0.0),
    MaterialParameter("shear_modulus", "Pa", "shear modulus (solids)", least=0.0, default=0.0),
    MaterialParameter("nu", "m2/s", "kinematic viscosity (fluids)", least=0.0, default=0.0),
    _strength("yield_strength", "Pa", "yield strength of von Mises; 0: none (solids)"),
    _strength("cohesion", "Pa", "cohesion of Drucker and Prager (solids)"),
    _strength("friction_angle", "degrees", "angle of friction of Drucker and Prager (solids)", 90),
    _rheology("yield_stress", "Pa", "yield stress", HERSCHEL_BULKLEY),
    _rheology("consistency", "Pa s^n", "consistency", HERSCHEL_BULKLEY),
    _rheology("flow_index", "1", "flow index", HERSCHEL_BULKLEY, default=1.0),
    _rheology("regularisation", "s", "Papanastasiou's regularisation", HERSCHEL_BULKLEY),
    _rheology("mu_s", "1", "static coefficient of friction", MU_I),
    _rheology("mu_2", "1", "limiting coefficient of friction", MU_I),
    _rheology("inertial_number", "1", "reference inertial number", MU_I),
    _rheology("grain_diameter", "m", "diameter of the grains", MU_I),
    _rheology("grain_density", "kg/m3", "density of the grains", MU_I),
    _rheology("viscosity_max", "Pa s", "greatest viscosity", HERSCHEL_BULKLEY, MU_I),
)


@dataclass(frozen=True)
class Material:
    """A material with the values of the laboratory, not yet scaled by xi.

    `law` says how stress follows from motion: "fluid" (viscous, eqs. 6-7) or "solid" (elastic,
    eqs. 3-5, within a yield surface, eqs. 61-63).  `rheology` says how the viscosity of a fluid
    follows from the rate of strain (eqs. 64-65).  The numbers are those of MATERIAL_PARAMETERS, in
    their units.
    """

    name: str
    law: str
    rho0: float
    speedsound: float
    shear_modulus: float
    nu: float
    yield_strength: float = 0.0
    cohesion: float = 0.0
    friction_angle: float = 0.0
    yield_stress: float = 0.0
    consistency: float = 0.0
    flow_index: float = 1.0
    regularisation: float = 0.0
    mu_s: float = 0.0
    mu_2: float = 0.0
    inertial_number: float = 0.0
    grain_diameter: float = 0.0
    grain_density: float = 0.0
    viscosity_max: float = 0.0
    rheology: str = "newtonian"

    def scaled(self, xi: float) -> Material:
        """The material of a run with reduced sound speed: c0 -> xi c0, mu -> xi^2 mu (eq. 19).

        Strengths stay: they stand against gravity, which is not reduced.
        """
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
        return _checked(replace(base, name=name, **table))
    values = {p.name: p.default for p in MATERIAL_PARAMETERS}
    values |= {"law": None, "rheology": "newtonian"} | dict(table)
    missing = [key for key, value in values.items() if value is None]
    if missing:
        raise MaterialError(
            name,
            f"a new material needs {', '.join(sorted(missing))}, or based_on = a known material",
        )
    return _checked(Material(name=name, **values))


# What each rheology cannot do without.
_NEEDED = {
    HERSCHEL_BULKLEY: ("consistency", "regularisation", "flow_index", "viscosity_max"),
    MU_I: ("mu_s", "inertial_number", "grain_diameter", "grain_density", "viscosity_max"),
    "newtonian": (),
}


def _checked(material: Material) -> Material:
    """The material, if its numbers fit together and none of them would be left unused."""

    def refuse(message: str) -> None:
        raise MaterialError(material.name, message)

    if material.law == "solid" and material.rheology != "newtonian":
        refuse(f'rheology = "{material.rheology}" is for fluids; this material is a solid')
    for parameter in MATERIAL_PARAMETERS:
        if getattr(material, parameter.name) in (parameter.default, None):
            continue
        if parameter.law not in (None, material.law):
            refuse(f"{parameter.name} is for {parameter.law}s; this material is a {material.law}")
        if parameter.rheologies and material.rheology not in parameter.rheologies:
            allowed = " or ".join(f'"{rheology}"' for rheology in parameter.rheologies)
            refuse(
                f"{parameter.name} is for rheology = {allowed}; "
                f'this material is "{material.rheology}"'
            )
    for name in _NEEDED[material.rheology]:
        if getattr(material, name) <= 0:
            refuse(f'rheology = "{material.rheology}" needs {name}, greater than 0')
    if material.mu_2 < material.mu_s:
        refuse(f"mu_2 = {material.mu_2:g} must be at least mu_s = {material.mu_s:g}")
    if material.yield_strength > 0 and (material.cohesion > 0 or material.friction_angle > 0):
        refuse("yield_strength excludes cohesion and friction_angle: give one or the others")
    return material
