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
    """One number that describes a material: > above or >= least, < below or <= most."""

    name: str
    unit: str
    doc: str
    above: float | None = None
    least: float | None = None
    below: float | None = LIMIT
    most: float | None = None
    default: float | None = None
    optional: bool = False  # else a new material must give what has no default
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
    _rheology("flow_index", "", "flow index", HERSCHEL_BULKLEY, default=1.0),
    _rheology("regularisation", "s", "Papanastasiou's regularisation", HERSCHEL_BULKLEY),
    _rheology("mu_s", "", "static coefficient of friction", MU_I),
    _rheology("mu_2", "", "limiting coefficient of friction", MU_I),
    _rheology("inertial_number", "", "reference inertial number", MU_I),
    _rheology("grain_diameter", "m", "diameter of the grains", MU_I),
    _rheology("grain_density", "kg/m3", "density of the grains", MU_I),
    _rheology("viscosity_max", "Pa s", "greatest viscosity", HERSCHEL_BULKLEY, MU_I),
    # Of bodies that touch.  Of a pair, the means of restitution and of the frictions count.
    MaterialParameter(
        "restitution",
        "",
        "coefficient of restitution",
        above=0.0,
        below=None,
        most=1.0,
        default=0.7,
    ),
    MaterialParameter("friction", "", "coefficient of friction", least=0.0, default=0.6),
    MaterialParameter(
        "rolling_friction", "", "coefficient of rolling friction", least=0.0, default=0.0
    ),
    MaterialParameter(
        "young_modulus", "Pa", "Young's modulus (default: of c0 and mu0)", above=0.0, optional=True
    ),
    MaterialParameter(
        "poisson_ratio",
        "",
        "Poisson's ratio (default: of c0 and mu0)",
        least=0.0,
        below=0.5,
        optional=True,
    ),
)

_DEFAULT = {parameter.name: parameter.default for parameter in MATERIAL_PARAMETERS}


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
    restitution: float = _DEFAULT["restitution"]
    friction: float = _DEFAULT["friction"]
    rolling_friction: float = _DEFAULT["rolling_friction"]
    young_modulus: float | None = None
    poisson_ratio: float | None = None
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

    @property
    def elasticity(self) -> tuple[float, float]:
        """Young's modulus, Pa, and Poisson's ratio; what is not given follows from the others.

        K = rho0 c0^2 and mu give nu = (3K - 2 mu)/(6K + 2 mu) and E = 3K (1 - 2 nu) of isotropic
        elasticity; without a shear modulus nu is 1/4.
        """
        bulk, shear = self.rho0 * self.speedsound**2, self.shear_modulus
        ratio = self.poisson_ratio
        if ratio is None:
            ratio = max(0.0, (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear)) if shear else 0.25
        modulus = self.young_modulus
        return (3 * bulk * (1 - 2 * ratio) if modulus is None else modulus), ratio

    def scaled(self, xi: float) -> Material:
        """The material of a run with reduced sound speed: c0 -> xi c0, mu -> xi^2 mu (eq. 19).

        Strengths stay: they stand against gravity, which is not reduced.
        """
        return replace(
            self, speedsound=xi * self.speedsound, shear_modulus=xi**2 * self.shear_modulus
        )


# Table 1 of the paper; the viscosity of water is given under eq. 7.  Contacts: friction of rock is
# Byerlee's (1978) at low stress, 0.6; that of aluminium is such that rock on it has 0.5;
# restitution is the middle of the usual range of rock, 0.5 to 0.9.  Typical values, not
# measurements: what is measured of a pair is always better.
BUILT_IN = {
    "water": Material("water", "fluid", 1000.0, 1400.0, 0.0, 1e-6),
    "basalt": Material("basalt", "solid", 2750.0, 3116.0, 22.7e9, 0.0, 0.7, 0.6),
    "aluminium": Material("aluminium", "solid", 2700.0, 5277.0, 25.5e9, 0.0, 0.7, 0.4),
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
    values = _DEFAULT | {"law": None, "rheology": "newtonian"} | dict(table)
    optional = {p.name for p in MATERIAL_PARAMETERS if p.optional}
    missing = [key for key, value in values.items() if value is None and key not in optional]
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
