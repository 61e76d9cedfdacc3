"""The laws that a scenario chooses by name, with the parameters that only they have.

The core knows each law under the same name, and its parameters under the same names: see
core/physics/rheology.hpp, equation_of_state.hpp, hyperelastic.hpp and fracture.hpp.  A new law is
declared here and named there; what is not a parameter of every material stands with the law.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from ..schemes import RESOLVED, UETA2022
from .parameters import LIMIT, MaterialParameter

FASTEST = 1000.0  # rate of strain, 1/s, up to which a law is asked for its least viscosity
RATES = 100  # that are asked
MOST_FLAWS = 1e99  # 1/m3, that `weibull_k` is below


def _no_objection(numbers: Mapping[str, float]) -> str | None:
    return None


@dataclass(frozen=True)
class Law:
    """A law, the parameters of its own, and the schemes that obey it.

    `needed` are the parameters that must be given, greater than 0.  `objection(numbers)` says what
    is wrong with parameters that do not fit together, or None.
    """

    name: str
    doc: str
    parameters: tuple[MaterialParameter, ...] = ()
    needed: tuple[str, ...] = ()
    schemes: tuple[str, ...] = (UETA2022, RESOLVED)
    objection: Callable[[Mapping[str, float]], str | None] = _no_objection


def _table(*laws: Law) -> dict[str, Law]:
    return {law.name: law for law in laws}


def _fluid(
    name: str, unit: str, doc: str, default: float = 0.0, below: float = LIMIT
) -> MaterialParameter:
    return MaterialParameter(name, unit, doc, least=0.0, below=below, default=default, law="fluid")


def _friction_falls(numbers: Mapping[str, float]) -> str | None:
    if numbers["mu_2"] < numbers["mu_s"]:
        return f"mu_2 = {numbers['mu_2']:g} must be at least mu_s = {numbers['mu_s']:g}"
    return None


def _power_law(numbers: Mapping[str, float], rate: float) -> float:
    """Viscosity, Pa s, of eq. 64 without its upper bound."""
    yields = -math.expm1(-numbers["regularisation"] * rate)
    exponent = (numbers["flow_index"] - 1) * math.log(rate)
    flow = numbers["consistency"] * math.exp(min(exponent, 100.0))
    return numbers["yield_stress"] * yields / rate + flow


def _roots(numbers: Mapping[str, float], rate: float) -> float:
    """Viscosity, Pa s, of eq. 66 without its upper bound."""
    yields = -math.expm1(-((numbers["regularisation"] * rate) ** 0.5))
    plastic = (numbers["yield_stress"] / rate) ** 0.5 * yields
    return (plastic + numbers["casson_viscosity"] ** 0.5) ** 2


def _is_cut(
    viscosity: Callable[[Mapping[str, float], float], float],
) -> Callable[[Mapping[str, float]], str | None]:
    """The objection to a greatest viscosity that the law has at no rate of strain."""

    def objection(numbers: Mapping[str, float]) -> str | None:
        slowest = min(1 / numbers["regularisation"], FASTEST)
        ratio = (FASTEST / slowest) ** (1 / RATES)
        least = min(viscosity(numbers, slowest * ratio**k) for k in range(RATES + 1))
        most = numbers["viscosity_max"]
        if most >= least * (1 - 1e-9):
            return None
        return (
            f"viscosity_max = {most:g} Pa s is less than the viscosity of the law itself, which is "
            f"{least:.4g} Pa s or more at rates of strain from {slowest:.3g} to {FASTEST:g} 1/s: "
            "give it more than that"
        )

    return objection


_YIELD_STRESS = _fluid("yield_stress", "Pa", "yield stress")
_FLOW_INDEX = MaterialParameter("flow_index", "", "flow index", above=0.0, default=1.0, law="fluid")
_REGULARISATION = _fluid("regularisation", "s", "Papanastasiou's regularisation")
_VISCOSITY_MAX = _fluid("viscosity_max", "Pa s", "greatest viscosity")

# How the viscosity of a fluid follows from the rate of strain: `rheology` of a material.
RHEOLOGIES = _table(
    Law("newtonian", "constant kinematic viscosity nu, eq. 7"),
    Law(
        "herschel_bulkley",
        "yield stress and power law, eq. 64",
        parameters=(
            _YIELD_STRESS,
            _fluid("consistency", "Pa s^n", "consistency"),
            _FLOW_INDEX,
            _REGULARISATION,
            _VISCOSITY_MAX,
        ),
        needed=("consistency", "regularisation", "flow_index", "viscosity_max"),
        schemes=(RESOLVED,),
        objection=_is_cut(_power_law),
    ),
    Law(
        "casson",
        "yield stress and a viscosity that falls, eq. 66",
        parameters=(
            _YIELD_STRESS,
            _fluid("casson_viscosity", "Pa s", "Casson viscosity"),
            _REGULARISATION,
            _VISCOSITY_MAX,
        ),
        needed=("casson_viscosity", "regularisation", "viscosity_max"),
        schemes=(RESOLVED,),
        objection=_is_cut(_roots),
    ),
    Law(
        "mu_i",
        "friction of dense grains, dry or with water in their pores, eqs. 65 and 91",
        parameters=(
            _fluid("mu_s", "", "static coefficient of friction"),
            _fluid("mu_2", "", "limiting coefficient of friction"),
            _fluid("inertial_number", "", "reference inertial number"),
            _fluid("grain_diameter", "m", "diameter of the grains"),
            _fluid("grain_density", "kg/m3", "density of the grains"),
            _VISCOSITY_MAX,
            _fluid(
                "pore_pressure_ratio", "", "pressure of the pore water over all of it", below=1.0
            ),
        ),
        needed=("mu_s", "inertial_number", "grain_diameter", "grain_density", "viscosity_max"),
        schemes=(RESOLVED,),
        objection=_friction_falls,
    ),
)

# Of water with p_inf = 6e8 Pa (Saurel & Abgrall, J. Comput. Phys. 150, 1999): c0 = 1625 m/s.
_GAMMA = MaterialParameter(
    "gamma", "", "exponent of the isentrope", above=1.0, most=100.0, default=4.4, law="fluid"
)

# How pressure follows from density: `eos` of a scenario.
EQUATIONS_OF_STATE = _table(
    Law("birch_murnaghan", "Birch and Murnaghan's, eq. 8", schemes=(UETA2022,)),
    Law("linear", "pressure in proportion to compression, eq. 26", schemes=(RESOLVED,)),
    Law("tait", "Tait's with the exponent 7 of water, eq. 26", schemes=(RESOLVED,)),
    Law(
        "stiffened_gas",
        "isentrope of a stiffened gas, Tait's with an exponent gamma, eq. 68",
        parameters=(_GAMMA,),
        schemes=(RESOLVED,),
    ),
)

# How the stress of a deformable body follows from its deformation: `elastic_law` of a body.
HYPERELASTIC_LAWS = _table(
    Law("st_venant_kirchhoff", "linear in the Green strain, eq. 81", schemes=(RESOLVED,)),
    Law("neo_hookean", "compressible rubber, eq. 81", schemes=(RESOLVED,)),
)
# Of deformable bodies that say nothing else.
ELASTIC_DEFAULTS = {
    "elastic_law": "st_venant_kirchhoff",
    "damping": 0.02,
    "hourglass": 0.5,
    "flaw_seed": 1,
}

NO_FRACTURE = "none"


def _breaking(name: str, unit: str, doc: str, below: float = LIMIT) -> MaterialParameter:
    return MaterialParameter(
        name, unit, doc, above=0.0, below=below, default=0.0, law="solid", scheme=RESOLVED
    )


# How the material of a deformable body breaks: `fracture` of a material.
FRACTURES = _table(
    Law(NO_FRACTURE, "does not break", schemes=(RESOLVED,)),
    Law(
        "cohesive",
        "stress across a crack falls as it opens, eq. 110",
        parameters=(
            _breaking("tensile_strength", "Pa", "tensile strength"),
            _breaking("fracture_energy", "J/m2", "energy that a crack takes by its area"),
        ),
        needed=("tensile_strength", "fracture_energy"),
        schemes=(RESOLVED,),
    ),
    Law(
        "grady_kipp",
        "damage that grows from flaws of a Weibull distribution, eqs. 112 to 114",
        parameters=(
            _breaking(
                "weibull_k", "1/m3", "flaws of a volume below a strain of 1", below=MOST_FLAWS
            ),
            _breaking("weibull_m", "", "Weibull's exponent", below=100.0),
        ),
        needed=("weibull_k", "weibull_m"),
        schemes=(RESOLVED,),
    ),
)


def fracture_keys(fracture: str | None = None) -> set[str]:
    """The keys of a material that only say how it breaks; those that a law of fracture has not."""
    names = {p.name for law in FRACTURES.values() for p in law.parameters} | {"fracture"}
    if fracture in (None, NO_FRACTURE):
        return names
    return names - {p.name for p in FRACTURES[fracture].parameters} - {"fracture"}


def laws_of(family: Mapping[str, Law], scheme: str) -> tuple[str, ...]:
    """The names of the laws of a family that a scheme obeys."""
    return tuple(name for name, law in family.items() if scheme in law.schemes)


def equation_of_state(scheme: str, chosen: str) -> str:
    """The equation of state of a run: the chosen one, or the only one that its scheme has."""
    obeyed = laws_of(EQUATIONS_OF_STATE, scheme)
    return chosen if chosen in obeyed else obeyed[0]


def owners(family: Mapping[str, Law], parameter: MaterialParameter) -> tuple[str, ...]:
    """The names of the laws that have a parameter of their own of that name."""
    return tuple(
        law.name for law in family.values() if parameter.name in (p.name for p in law.parameters)
    )


def parameters_of(families: Iterable[Mapping[str, Law]]) -> dict[str, MaterialParameter]:
    """The parameters of all laws by name, each once."""
    return {
        parameter.name: parameter
        for family in families
        for law in family.values()
        for parameter in law.parameters
    }
