"""A material: its parameters, declared once, and the built-in table of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from ..schemes import RESOLVED, UETA2022
from .laws import EQUATIONS_OF_STATE, FRACTURES, NO_FRACTURE, RHEOLOGIES, owners, parameters_of
from .parameters import LIMIT, MaterialParameter

LAWS = ("fluid", "solid")


def _strength(name: str, unit: str, doc: str, below: float = LIMIT) -> MaterialParameter:
    return MaterialParameter(
        name, unit, doc, least=0.0, below=below, default=0.0, law="solid", scheme=UETA2022
    )


def _tension(
    name: str, doc: str, default: float, least: float | None = None, most: float | None = None
) -> MaterialParameter:
    return MaterialParameter(
        name,
        "Pa",
        f"{doc} (fluids)",
        least=least,
        most=most,
        default=default,
        law="fluid",
        scheme=RESOLVED,
    )


_COMMON = (
    MaterialParameter("rho0", "kg/m3", "reference density", above=0.0),
    MaterialParameter("speedsound", "m/s", "sound speed at the reference density", above=0.0),
    MaterialParameter(
        "shear_modulus", "Pa", "shear modulus (solids)", least=0.0, default=0.0, law="solid"
    ),
    MaterialParameter(
        "nu", "m2/s", "kinematic viscosity (fluids)", least=0.0, default=0.0, law="fluid"
    ),
    _tension("cavitation_pressure", "gauge pressure at which it tears", most=0.0, default=-9.9e4),
    _tension(
        "air_entry_suction",
        "suction that pores between bodies hold until air enters",
        least=0.0,
        default=0.0,
    ),
    _strength("yield_strength", "Pa", "yield strength of von Mises; 0: none (solids)"),
    _strength("cohesion", "Pa", "cohesion of Drucker and Prager (solids)"),
    _strength("friction_angle", "degrees", "angle of friction of Drucker and Prager (solids)", 90),
)
# Of bodies that touch.  Of a pair, the means of restitution and of the frictions count.
_CONTACT = (
    MaterialParameter(
        "restitution",
        "",
        "coefficient of restitution",
        above=0.0,
        below=None,
        most=1.0,
        default=0.7,
        law="solid",
        scheme=RESOLVED,
    ),
    MaterialParameter(
        "friction",
        "",
        "coefficient of friction",
        least=0.0,
        default=0.6,
        law="solid",
        scheme=RESOLVED,
    ),
    MaterialParameter(
        "rolling_friction",
        "",
        "coefficient of rolling friction",
        least=0.0,
        default=0.0,
        law="solid",
        scheme=RESOLVED,
    ),
    MaterialParameter(
        "young_modulus",
        "Pa",
        "Young's modulus (default: of c0 and mu0)",
        above=0.0,
        optional=True,
        law="solid",
        scheme=RESOLVED,
    ),
    MaterialParameter(
        "poisson_ratio",
        "",
        "Poisson's ratio (default: of c0 and mu0)",
        least=0.0,
        below=0.5,
        optional=True,
        law="solid",
        scheme=RESOLVED,
    ),
)


def _with_owners(parameter: MaterialParameter) -> MaterialParameter:
    families = (RHEOLOGIES, EQUATIONS_OF_STATE, FRACTURES)
    names = [name for family in families for name in owners(family, parameter)]
    return replace(parameter, doc=f"{parameter.doc} ({', '.join(names)})")


_OF_LAWS = parameters_of((RHEOLOGIES, EQUATIONS_OF_STATE, FRACTURES))
MATERIAL_PARAMETERS = (*_COMMON, *map(_with_owners, _OF_LAWS.values()), *_CONTACT)
DEFAULTS = {parameter.name: parameter.default for parameter in MATERIAL_PARAMETERS}


def _defaults_of_laws() -> dict[str, float]:
    return {name: parameter.default or 0.0 for name, parameter in _OF_LAWS.items()}


def _default(name: str) -> Any:
    return field(default=DEFAULTS[name])


@dataclass(frozen=True)
class Material:
    """A material with the values of the laboratory, not yet scaled by xi.

    `law` says how stress follows from motion: "fluid" (viscous, eqs. 6-7) or "solid" (elastic,
    eqs. 3-5, within a yield surface, eqs. 61-63).  `rheology` names one of RHEOLOGIES,
    `fracture` one of FRACTURES.  The numbers are those of MATERIAL_PARAMETERS, in their units;
    `of_laws` has those of single laws.
    """

    name: str
    law: str
    rho0: float
    speedsound: float
    shear_modulus: float
    nu: float
    restitution: float = _default("restitution")
    friction: float = _default("friction")
    rolling_friction: float = _default("rolling_friction")
    young_modulus: float | None = None
    poisson_ratio: float | None = None
    cavitation_pressure: float = _default("cavitation_pressure")
    air_entry_suction: float = _default("air_entry_suction")
    yield_strength: float = _default("yield_strength")
    cohesion: float = _default("cohesion")
    friction_angle: float = _default("friction_angle")
    rheology: str = "newtonian"
    fracture: str = NO_FRACTURE  # of its deformable bodies
    has_sound: bool = True  # False: of a solid that was given no sound speed, and may be rigid
    of_laws: Mapping[str, float] = field(default_factory=_defaults_of_laws)

    def with_values(self, values: Mapping[str, Any]) -> Material:
        """The material with other values; keys are those of a scenario's table."""
        of_laws = {**self.of_laws, **{k: v for k, v in values.items() if k in _OF_LAWS}}
        others = {key: value for key, value in values.items() if key not in _OF_LAWS}
        if values.get("speedsound") is not None:
            others["has_sound"] = True
        return replace(self, of_laws=of_laws, **others)

    def table(self) -> dict[str, Any]:
        """All values by the keys of a scenario's table, and the name."""
        values = asdict(self)
        del values["has_sound"]
        return values | values.pop("of_laws")

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
