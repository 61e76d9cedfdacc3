"""Every key of contacts and materials changes the run or is refused: see walk.py."""

from __future__ import annotations

from doseki.scenario.tables.contact import Contact
from doseki.scenario.tables.material import MaterialTable

from .walk import NONE, REFUSED, cases, ignored, outcome, replaced, text_of

# Overlap is also what may lie over one another at the start; a scenario that names the speed may
# be run with either stiffness.
CONTACT = {
    "law": ["hertz"],
    "overlap": ["0.05"],
    "speed": ["2"],
    "stiffness": ["material"],
    "steps": ["40"],
}
MATERIAL = {
    "law": ["{other}"],
    "rheology": ["herschel_bulkley"],
    "based_on": ["aluminium", "mud"],
    "rho0": ["2000"],
    "speedsound": ["3000 with xi=0.05"],
    "shear_modulus": ["1e9"],
    "nu": ["1e-2"],
    "cavitation_pressure": ["-1 with body.water.pressure=-50"],
    "air_entry_suction": ["1e9 with body.water.pressure=-50; eta=2"],
    "yield_strength": ["10"],
    "cohesion": ["10"],
    "friction_angle": ["10"],
    "yield_stress": ["5", "5 with {hb}"],
    "consistency": ["5", "5 with {hb}"],
    "flow_index": ["0.5", "0.5 with {hb}"],
    "regularisation": ["0.5", "0.5 with {hb}"],
    "viscosity_max": ["0.5", "1.05 with {hb}"],
    "casson_viscosity": ["5", "5 with {casson}"],
    "mu_s": ["0.5", "0.5 with {mu}"],
    "mu_2": ["0.9", "0.9 with {mu}"],
    "inertial_number": ["0.5", "0.5 with {mu}"],
    "grain_diameter": ["0.02", "0.02 with {mu}"],
    "grain_density": ["2000", "2000 with {mu}"],
    "pore_pressure_ratio": ["0.5", "0.5 with {mu}"],
    "preset": ["glass_beads with {mud}", "obrien_julien"],
    "soil": ["glenwood_1", "glenwood_1 with {mud}"],
    "cv": ["0.2", "0.2 with {mud}"],
    "solid_density": ["2000", "2000 with {mud}"],
    "gamma": ["5", "5 with eos=stiffened_gas"],
    "restitution": ["0.2"],
    "friction": ["0.1"],
    "rolling_friction": ["0.3"],
    "young_modulus": ["1e6"],
    "poisson_ratio": ["0.4"],
    # Of bodies that break: tests/core/bodies/test_breaking_scenarios.py.
    "fracture": ["cohesive"],
    "tensile_strength": ["1e6"],
    "fracture_energy": ["5"],
    "weibull_k": ["1e9"],
    "weibull_m": ["9"],
}
# What softened contacts do not ask for, and elastic bodies and other contacts do.
ELASTICITY = ("shear_modulus", "speedsound", "young_modulus", "poisson_ratio")
LAWS = {
    "hb": "rheology=herschel_bulkley; yield_stress=1; consistency=1; regularisation=0.1;"
    " viscosity_max=50",
    "casson": "rheology=casson; yield_stress=1; casson_viscosity=1; regularisation=0.1;"
    " viscosity_max=50",
    "mud": "preset=obrien_julien; soil=aspen_pit_1; cv=0.3",
    "mu": "rheology=mu_i; mu_s=0.03; mu_2=0.06; inertial_number=0.3; grain_diameter=0.01;"
    " grain_density=2500; viscosity_max=50",
}
# Two rocks that touch each other and the floor, askew.
ROCKS = """
[body.one]
shape = "{ball}"
material = "rock"
centre = [1.0, @10.2495]
radius = 0.25
velocity = [1, @0-1]
[body.two]
shape = "{ball}"
material = "rock"
centre = [1.4, @10.5485]
radius = 0.25
velocity = [-1, @00]
"""


@cases
def test_contacts_and_materials(tmp_path, scheme, dim):
    path = tmp_path / "case.toml"
    tables = '[material.mud]\nbased_on = "water"\n' + ROCKS
    text = text_of(scheme, dim, tables).replace("{ball}", "disc" if dim == 2 else "sphere")
    path.write_text(text)
    assert outcome(str(path), ()) != REFUSED
    assert ignored(str(path), "contact.", sorted(Contact.model_fields), CONTACT) == NONE
    for material in ("water", "rock"):
        prefix = f"material.{material}."
        laws = {"other": "solid" if material == "water" else "fluid"}
        laws |= {k: prefix + v.replace("; ", f"; {prefix}") for k, v in LAWS.items()}
        values = {key: [replaced(v, laws) for v in entries] for key, entries in MATERIAL.items()}
        if scheme == "resolved":
            for key in ELASTICITY:
                also = "; " if " with " in values[key][0] else " with "
                values[key] = [f"{values[key][0]}{also}contact.stiffness=material"]
        assert ignored(str(path), prefix, sorted(MaterialTable.model_fields), values) == NONE
