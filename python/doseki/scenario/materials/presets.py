"""Presets: materials whose numbers follow from measurements that were published.

A preset gives what a table [material.NAME] does not.  Its own keys are those of `keys`; `values`
makes the numbers of a material of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

WATER = 1000.0  # kg/m3
QUARTZ = 2650.0  # kg/m3
POISE, DYNE_PER_CM2 = 0.1, 0.1  # Pa s, Pa
CONCENTRATIONS = (0.10, 0.45)  # that O'Brien and Julien measured
REST = 10.0  # s; rates of strain below 1/REST count as rest, unless the scenario says otherwise


class Mudflow(NamedTuple):
    """Coefficients of a exp(b cv): yield stress in dyn/cm2, viscosity in poise."""

    yield_a: float
    yield_b: float
    viscosity_a: float
    viscosity_b: float


# O'Brien & Julien, J. Hydraul. Eng. 114(8), 877-887 (1988), table 2, field samples of Colorado.
# The names of the second pit, the watershed and the source area are those of later tables of the
# same rows; the paper has "natural soil source" and "mine fill source" for the last two.
SOILS = {
    "aspen_pit_1": Mudflow(0.181, 25.7, 0.0360, 22.1),
    "aspen_pit_2": Mudflow(2.72, 10.4, 0.0538, 14.5),
    "aspen_natural_soil": Mudflow(0.152, 18.7, 0.00136, 28.4),
    "aspen_mine_fill": Mudflow(0.0473, 21.1, 0.128, 12.0),
    "aspen_watershed": Mudflow(0.0383, 19.6, 0.000495, 27.1),
    "aspen_mine_source_area": Mudflow(0.291, 14.3, 0.000201, 33.1),
    "glenwood_1": Mudflow(0.0345, 20.1, 0.00283, 23.0),
    "glenwood_2": Mudflow(0.0765, 16.9, 0.0648, 6.20),
    "glenwood_3": Mudflow(0.000707, 29.8, 0.00632, 19.9),
    "glenwood_4": Mudflow(0.00172, 29.5, 0.000602, 33.1),
}


@dataclass(frozen=True)
class Preset:
    """A published material.

    `values(keys)` makes the numbers of a material, SI, of the preset's own keys and those of
    DECIDED that it leaves open; it raises ValueError, with one sentence, for those that are outside
    of what was measured.
    """

    name: str
    doc: str
    needed: tuple[str, ...]
    optional: tuple[str, ...]
    values: Callable[[Mapping[str, Any]], dict[str, Any]]
    open: tuple[str, ...] = ()


def mud(soil: str, cv: float) -> tuple[float, float]:
    """Yield stress, Pa, and viscosity, Pa s, of a mudflow, eq. (94).

    `cv` is the volume of sediment over all of it.  Raises ValueError outside of what was measured.
    """
    low, high = CONCENTRATIONS
    if not low <= cv <= high:
        raise ValueError(
            f"cv = {cv:g}: measured from {low:g} to {high:g} (volume of sediment over all of it)"
        )
    row = SOILS[soil]
    stress = DYNE_PER_CM2 * row.yield_a * math.exp(row.yield_b * cv)
    return stress, POISE * row.viscosity_a * math.exp(row.viscosity_b * cv)


def _obrien_julien(keys: Mapping[str, Any]) -> dict[str, Any]:
    cv, solid = keys["cv"], keys.get("solid_density", QUARTZ)
    stress, viscosity = mud(keys["soil"], cv)
    law = {"yield_stress": stress, "consistency": viscosity, "regularisation": REST}
    law |= {key: keys[key] for key in law if key in keys}
    return {
        "law": "fluid",
        "rho0": WATER + cv * (solid - WATER),
        "speedsound": 1400.0,
        "rheology": "herschel_bulkley",
        "flow_index": 1.0,
        "viscosity_max": law["consistency"] + law["regularisation"] * law["yield_stress"],
    } | law


def _glass_beads(_: Mapping[str, Any]) -> dict[str, Any]:
    """The glass beads of Jop, Forterre & Pouliquen (Nature 441, 2006), 60 % of the volume."""
    return {
        "law": "fluid",
        "rho0": 1500.0,
        "speedsound": 1400.0,
        "rheology": "mu_i",
        "mu_s": math.tan(math.radians(20.9)),
        "mu_2": math.tan(math.radians(32.76)),
        "inertial_number": 0.279,
        "grain_diameter": 0.53e-3,
        "grain_density": 2500.0,
    }


class Cohesive(NamedTuple):
    """How a solid cracks: strength, Pa, and toughness, Pa m^0.5, or fracture energy, J/m2."""

    strength: float
    toughness: float = 0.0
    energy: float = 0.0


@dataclass(frozen=True)
class Rock:
    """A solid that breaks: density, kg/m3, Young's modulus, Pa, Poisson's ratio, and how it does.

    `flaws` are `weibull_k` and `weibull_m`; where it has them, they are its fracture unless a table
    says "cohesive".
    """

    density: float
    young: float
    poisson: float
    cohesive: Cohesive
    flaws: tuple[float, float] | None = None

    def values(self, keys: Mapping[str, Any]) -> dict[str, Any]:
        """The numbers of a material, with those of the fracture that the keys choose."""
        fracture = keys.get("fracture", "grady_kipp" if self.flaws else "cohesive")
        return {
            "law": "solid",
            "rho0": self.density,
            "young_modulus": self.young,
            "poisson_ratio": self.poisson,
            "fracture": fracture,
        } | self._of_fracture(fracture)

    def _of_fracture(self, fracture: str) -> dict[str, float]:
        """The fracture energy of a toughness is that of plane strain."""
        if fracture == "grady_kipp" and self.flaws:
            return dict(zip(("weibull_k", "weibull_m"), self.flaws, strict=True))
        if fracture != "cohesive":
            return {}
        strength, toughness, energy = self.cohesive
        energy = energy or toughness**2 * (1 - self.poisson**2) / self.young
        return {"tensile_strength": strength, "fracture_energy": energy}


# Basalt: moduli of 26.7 GPa (bulk) and 22.7 GPa (shear), and the flaws with which the impacts of
# Nakamura & Fujiwara came out as they were measured (Benz & Asphaug, Icarus 107, 1994); strength of
# intact basalt: Schultz (Rock Mech. Rock Eng. 28, 1995); toughness of Icelandic basalt: Meredith
# et al. (final report of PRENLAB-2, Icelandic Meteorological Office, 2001).
# Granite is Westerly's and sandstone Berea's, with toughness by Atkinson & Meredith, in Fracture
# Mechanics of Rock (1987), and round numbers for the rest. Measured: sandstone 13.1 GPa and 0.17,
# drained, at 10 MPa (Hart & Wang, J. Geophys. Res. 100, 1995); granite of Lac du Bonnet 8.8 MPa in
# Brazilian tests, 6.9 MPa when pulled (Rock Mech. Rock Eng. 2019, doi 10.1007/s00603-019-01946-x).
# Concrete C30 by the fib Model Code 2010: strength 0.3 * 30^(2/3) MPa (5.1-3a), fracture energy
# 73 * 38^0.18 J/m2 (5.1-9), Young's modulus 21.5 * 3.8^(1/3) GPa (5.1-21).
_BASALT = Rock(2700.0, 53.1e9, 0.169, Cohesive(14.5e6, toughness=2.71e6), flaws=(5e34, 8.5))
_GRANITE = Rock(2650.0, 60e9, 0.25, Cohesive(10e6, toughness=1.6e6))
_SANDSTONE = Rock(2200.0, 14e9, 0.2, Cohesive(4e6, toughness=0.28e6))
_CONCRETE = Rock(2400.0, 33.6e9, 0.2, Cohesive(2.9e6, energy=140.5))


def _rock(name: str, doc: str, rock: Rock) -> Preset:
    return Preset(name, doc, (), (), rock.values, ("fracture",))


PRESETS = {
    preset.name: preset
    for preset in (
        Preset(
            "obrien_julien",
            "mud by its concentration of sediment, O'Brien & Julien (1988), eq. 94",
            ("soil", "cv"),
            ("solid_density",),
            _obrien_julien,
        ),
        Preset(
            "glass_beads",
            "mu(I) of beads of 0.53 mm, Jop et al. (2006), eq. 65",
            (),
            (),
            _glass_beads,
        ),
        _rock("basalt", "basalt with flaws, Benz & Asphaug (1994), eq. 112", _BASALT),
        _rock("granite", "granite that breaks, eq. 110", _GRANITE),
        _rock("sandstone", "sandstone that breaks, eq. 110", _SANDSTONE),
        _rock("concrete", "concrete C30, fib Model Code 2010, eq. 110", _CONCRETE),
    )
}
KEYS = tuple(dict.fromkeys(k for p in PRESETS.values() for k in (*p.needed, *p.optional)))
DECIDED = ("law", "rheology", "fracture", "based_on")  # by a preset that leaves them not open


def without_preset(table: Mapping[str, Any]) -> dict[str, Any]:
    """A table of a material with what its preset says in place of the keys of the preset.

    What the table gives itself stays.  Raises ValueError for keys that do not go with the preset.
    """
    given = {key: value for key, value in table.items() if key not in ("preset", *KEYS)}
    own = {key: table[key] for key in KEYS if key in table}
    if "preset" not in table:
        for key in own:
            owner = " or ".join(f'"{p.name}"' for p in PRESETS.values() if key in _keys(p))
            raise ValueError(f"{key} goes with preset = {owner}")
        return given
    preset = PRESETS[table["preset"]]
    for key in DECIDED:
        if key in given and key not in preset.open:
            raise ValueError(f'{key} is decided by preset = "{preset.name}": remove one of them')
    for key in own:
        if key not in _keys(preset):
            raise ValueError(f'{key} is not a key of preset = "{preset.name}"')
    for key in preset.needed:
        if key not in own:
            raise ValueError(f'preset = "{preset.name}" needs {key}')
    return preset.values(own | given) | given


def _keys(preset: Preset) -> tuple[str, ...]:
    return (*preset.needed, *preset.optional)
