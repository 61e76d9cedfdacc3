"""Strength and rheology of materials: what is refused, and what a stored scenario brings back."""

from __future__ import annotations

import math

import pytest

from doseki.scenario.load import load_scenario
from doseki.scenario.materials import SOILS
from doseki.scenario.materials.presets import without_preset

from ..small_scenarios import BLOCK

RESOLVED = 'scheme = "resolved"\nspeed_max = 2'
MUD = """
[material.mud]
based_on = "water"
rheology = "herschel_bulkley"
yield_stress = 20
consistency = 2
flow_index = 0.5
regularisation = 100
viscosity_max = 1e3
"""
# Where its viscosity is least, its yield stress is not all there yet, Eq. (64).
YOUNG_MUD = MUD.replace("= 0.5", "= 2").replace("= 100", "= 1")
PAINT = """
[material.paint]
based_on = "water"
rheology = "casson"
yield_stress = 20
casson_viscosity = 2
regularisation = 100
viscosity_max = 1e3
"""
BEADS = """
[material.beads]
based_on = "water"
rheology = "mu_i"
mu_s = 0.38
mu_2 = 0.64
inertial_number = 0.28
grain_diameter = 5e-4
grain_density = 2500
viscosity_max = 50
"""
ASPEN = """
[material.aspen]
preset = "obrien_julien"
soil = "aspen_pit_1"
cv = 0.4
"""
GAS = """
[material.oil]
based_on = "water"
gamma = 3
"""
SAND = """
[material.sand]
based_on = "basalt"
cohesion = 10
friction_angle = 35
"""


def test_the_greatest_viscosity_of_mud_follows_its_yield_stress():
    """Or what has a higher one would be a liquid of the old one's greatest viscosity."""
    table = {"preset": "obrien_julien", "soil": "aspen_pit_1", "cv": 0.2}
    mud = without_preset(table | {"yield_stress": 1000.0})
    assert mud["viscosity_max"] == pytest.approx(10 * 1000, rel=1e-3)
    assert without_preset(table | {"viscosity_max": 7.0})["viscosity_max"] == 7.0


def block_of(name):
    """BLOCK of another material."""
    return BLOCK.replace("water", name)


@pytest.mark.parametrize(
    ("tables", "parts"),
    [
        (SAND.replace("35", "90"), ["material.sand.friction_angle = 90", "less than 90"]),
        (SAND.replace("10", "-1"), ["material.sand.cohesion = -1", "at least 0"]),
        (SAND + "yield_strength = 1e6", ["material.sand", "excludes cohesion and friction_angle"]),
        (SAND + "rheology = 'mu_i'", ["material.sand", "for fluids; this material is a solid"]),
        (SAND + "yield_stress = 5", ["material.sand", "yield_stress is for fluids"]),
        (SAND + "friction_angel = 5", ["material.sand.friction_angel", "friction_angle"]),
        (MUD + "cohesion = 5", ["material.mud", "cohesion is for solids"]),
        (SAND + "air_entry_suction = 5", ["material.sand", "air_entry_suction is for fluids"]),
        (MUD + "air_entry_suction = -5", ["material.mud.air_entry_suction = -5", "at least 0"]),
        (MUD + "cavitation_pressure = 5", ["cavitation_pressure = 5", "at most 0"]),
        (MUD + "mu_s = 0.3", ["mu_s is for rheology", '"mu_i"', "herschel_bulkley"]),
        (MUD.replace("2\n", "0\n"), ["material.mud", "needs consistency, greater than 0"]),
        (MUD.replace("viscosity_max = 1e3", ""), ["needs viscosity_max, greater than 0"]),
        (MUD.replace("regularisation = 100", ""), ["needs regularisation, greater than 0"]),
        (MUD.replace('"herschel_bulkley"', '"bingham"'), ["rheology = 'bingham'", "'mu_i'"]),
        (MUD.replace('rheology = "herschel_bulkley"', ""), ["yield_stress is for rheology"]),
        (MUD.replace('rheology = "herschel_bulkley"', ""), ['"herschel_bulkley" or "casson"']),
        (MUD + "casson_viscosity = 2", ["casson_viscosity is for rheology", '"casson"']),
        (PAINT + "consistency = 2", ["material.paint", "consistency is for rheology", "herschel"]),
        (PAINT.replace("casson_viscosity = 2\n", ""), ["needs casson_viscosity, greater than 0"]),
        (PAINT.replace("regularisation = 100", ""), ["needs regularisation, greater than 0"]),
        (PAINT.replace("viscosity_max = 1e3", ""), ["needs viscosity_max, greater than 0"]),
        (PAINT.replace("20", "-1"), ["material.paint.yield_stress = -1", "at least 0"]),
        (PAINT + "casson_viscocity = 2", ["did you mean casson_viscosity"]),
        (BEADS.replace("0.64", "0.3"), ["mu_2 = 0.3 must be at least mu_s = 0.38"]),
        (BEADS.replace("grain_density = 2500", ""), ["needs grain_density, greater than 0"]),
        (BEADS + "pore_pressure_ratio = 1", ["pore_pressure_ratio = 1", "less than 1"]),
        (MUD + "pore_pressure_ratio = 0.5", ["pore_pressure_ratio is for rheology", '"mu_i"']),
        (ASPEN.replace("aspen_pit_1", "aspen_pit_3"), ["soil = 'aspen_pit_3'", "'aspen_pit_1'"]),
        (ASPEN.replace("0.4", "0.46"), ["material.aspen: cv = 0.46", "from 0.1 to 0.45"]),
        (ASPEN.replace("0.4", "0.09"), ["material.aspen: cv = 0.09", "from 0.1 to 0.45"]),
        (ASPEN.replace("cv = 0.4", ""), ['preset = "obrien_julien" needs cv']),
        (ASPEN.replace("obrien_julien", "glass_beads"), ['soil is not a key of preset = "glass']),
        (
            ASPEN.replace('preset = "obrien_julien"', ""),
            ['soil goes with preset = "obrien_julien"'],
        ),
        (ASPEN + 'based_on = "water"', ["based_on is decided by preset"]),
        (ASPEN + 'rheology = "casson"', ["rheology is decided by preset"]),
        ('[material.beads]\npreset = "glass_beads"', ["needs viscosity_max, greater than 0"]),
        (MUD.replace("1e3", "0.05"), ["viscosity_max = 0.05 Pa s", "0.08325 Pa s or more"]),
        (MUD.replace("0.5", "1").replace("1e3", "1"), ["viscosity_max = 1 Pa s", "2.02 Pa s"]),
        (MUD.replace("0.5", "2").replace("1e3", "12"), ["viscosity_max = 12 Pa s", "12.65 Pa s"]),
        (MUD.replace("0.5", "-1"), ["material.mud.flow_index = -1", "greater than 0"]),
        (MUD.replace("0.5", "0"), ["material.mud.flow_index = 0", "greater than 0"]),
        (YOUNG_MUD.replace("1e3", "12"), ["viscosity_max = 12 Pa s", "12.31 Pa s"]),
        (PAINT.replace("1e3", "2"), ["viscosity_max = 2 Pa s", "2.42 Pa s or more"]),
    ],
)
def test_errors(write, error_of, tables, parts):
    text = error_of(write(top=RESOLVED, tables=BLOCK + tables))
    assert all(part in text for part in parts), text


STIFFENED = RESOLVED + '\neos = "stiffened_gas"'


@pytest.mark.parametrize(
    ("top", "tables", "parts"),
    [
        (RESOLVED, GAS, ["material.oil", 'gamma is for eos = "stiffened_gas"', '"linear"']),
        (STIFFENED, GAS.replace("3", "1"), ["material.oil.gamma = 1", "greater than 1"]),
        (STIFFENED, GAS.replace("3", "1e3"), ["material.oil.gamma = 1000", "at most 100"]),
        (STIFFENED, GAS.replace("water", "basalt"), ["gamma is for fluids"]),
        (STIFFENED, GAS.replace("gamma", "gama"), ["material.oil.gama", "did you mean gamma"]),
        ('eos = "stiffened_gas"', "", ["the scheme ueta2022 has birch_murnaghan alone"]),
    ],
)
def test_errors_of_equations_of_state(write, error_of, top, tables, parts):
    text = error_of(write(top=top, tables=BLOCK + tables))
    assert all(part in text for part in parts), text


def test_liquids_of_a_run_may_differ_in_gamma(write):
    scenario = load_scenario(write(top=STIFFENED, tables=BLOCK + GAS))
    gammas = {name: scenario.materials[name].of_laws["gamma"] for name in ("water", "oil")}
    assert gammas == {"water": 4.4, "oil": 3.0}


@pytest.mark.parametrize(("name", "table"), [("mud", MUD), ("paint", PAINT)])
def test_the_scheme_of_the_paper_has_newtonian_fluids_alone(write, error_of, name, table):
    text = error_of(write(top="", tables=block_of(name) + table))
    assert f"material.{name}.rheology" in text
    assert "newtonian" in text


@pytest.mark.parametrize(
    ("name", "table", "top"),
    [
        ("mud", MUD, RESOLVED),
        ("paint", PAINT, RESOLVED),
        ("beads", BEADS, RESOLVED),
        ("beads", BEADS + "pore_pressure_ratio = 0.5", RESOLVED),
        ("aspen", ASPEN, RESOLVED),
        ("oil", GAS, STIFFENED),
        ("sand", SAND, ""),
    ],
)
def test_a_stored_scenario_has_the_same_material(write, tmp_path, name, table, top):
    scenario = load_scenario(write(top=top, tables=block_of(name) + table))
    stored = tmp_path / "stored.toml"
    stored.write_text(scenario.effective_toml(), encoding="utf-8")
    again = load_scenario(str(stored))
    assert again.materials[name] == scenario.materials[name]
    assert (
        again.materials[name].scaled(0.1).friction_angle == scenario.materials[name].friction_angle
    )


# Table 2 of O'Brien & Julien (1988) in its own units, dyn/cm2 and poise, at cv = 0.3.
MEASURED = {
    "aspen_pit_1": (0.181 * math.exp(0.3 * 25.7), 3.60e-2 * math.exp(0.3 * 22.1)),
    "aspen_pit_2": (2.72 * math.exp(0.3 * 10.4), 5.38e-2 * math.exp(0.3 * 14.5)),
    "aspen_natural_soil": (0.152 * math.exp(0.3 * 18.7), 1.36e-3 * math.exp(0.3 * 28.4)),
    "aspen_mine_fill": (4.73e-2 * math.exp(0.3 * 21.1), 0.128 * math.exp(0.3 * 12.0)),
    "aspen_watershed": (3.83e-2 * math.exp(0.3 * 19.6), 4.95e-4 * math.exp(0.3 * 27.1)),
    "aspen_mine_source_area": (0.291 * math.exp(0.3 * 14.3), 2.01e-4 * math.exp(0.3 * 33.1)),
    "glenwood_1": (3.45e-2 * math.exp(0.3 * 20.1), 2.83e-3 * math.exp(0.3 * 23.0)),
    "glenwood_2": (7.65e-2 * math.exp(0.3 * 16.9), 6.48e-2 * math.exp(0.3 * 6.2)),
    "glenwood_3": (7.07e-4 * math.exp(0.3 * 29.8), 6.32e-3 * math.exp(0.3 * 19.9)),
    "glenwood_4": (1.72e-3 * math.exp(0.3 * 29.5), 6.02e-4 * math.exp(0.3 * 33.1)),
}


def test_every_soil_is_one_of_the_table():
    assert MEASURED.keys() == SOILS.keys()


@pytest.mark.parametrize("soil", MEASURED)
def test_mud_by_its_concentration(write, soil):
    table = ASPEN.replace("aspen_pit_1", soil).replace("0.4", "0.3")
    mud = load_scenario(write(top=RESOLVED, tables=block_of("aspen") + table)).materials["aspen"]
    stress, viscosity = (0.1 * number for number in MEASURED[soil])  # Pa, Pa s
    assert mud.rheology == "herschel_bulkley"
    assert mud.rho0 == pytest.approx(1000 + 0.3 * 1650)
    assert mud.of_laws["yield_stress"] == pytest.approx(stress, rel=1e-12)
    assert mud.of_laws["consistency"] == pytest.approx(viscosity, rel=1e-12)
    assert mud.of_laws["flow_index"] == 1


def test_what_a_table_says_itself_stands_over_its_preset(write):
    table = ASPEN + 'solid_density = "2.7 g/cm3"\nviscosity_max = 500\n'
    mud = load_scenario(write(top=RESOLVED, tables=block_of("aspen") + table)).materials["aspen"]
    assert mud.rho0 == pytest.approx(1000 + 0.4 * 1700)
    assert mud.of_laws["viscosity_max"] == 500
