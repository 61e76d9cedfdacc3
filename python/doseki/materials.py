"""Materials: the parameters, declared once, and the built-in table of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

LAWS = ("fluid", "solid")
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


MATERIAL_PARAMETERS = (
    MaterialParameter("rho0", "kg/m3", "reference density", above=0.0),
    MaterialParameter("speedsound", "m/s", "sound speed at the reference density", above=0.0),
    MaterialParameter("shear_modulus", "Pa", "shear modulus (solids)", least=0.0, default=0.0),
    MaterialParameter("nu", "m2/s", "kinematic viscosity (fluids)", least=0.0, default=0.0),
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
    eqs. 3-5).  The numbers are those of MATERIAL_PARAMETERS, in their units.
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
        """The material of a run with reduced sound speed: c0 -> xi c0, mu -> xi^2 mu (eq. 19)."""
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
        return replace(base, name=name, **table)
    values = _DEFAULT | {"law": None} | dict(table)
    optional = {p.name for p in MATERIAL_PARAMETERS if p.optional}
    missing = [key for key, value in values.items() if value is None and key not in optional]
    if missing:
        raise MaterialError(
            name,
            f"a new material needs {', '.join(sorted(missing))}, or based_on = a known material",
        )
    return Material(name=name, **values)
