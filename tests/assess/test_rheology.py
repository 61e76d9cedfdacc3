"""Fluids whose friction a run would not have are named before it."""

from __future__ import annotations

import pytest

from doseki.assess.rheology import rheology_findings
from doseki.scenario.load import load_scenario

SCENARIO = """\
dim = 2
scheme = "resolved"
dp = 0.02
time_max = 1
time_out = 1
speed_max = 3

[material.fluid]
based_on = "water"
{fluid}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.02
min = [0, -0.08]
max = [1, 0]

[body.layer]
shape = "box"
material = "fluid"
min = [0, 0]
max = [1, 0.2]
"""
WATER_ABOVE = """
[body.lake]
shape = "box"
material = "water"
min = [0, 0.2]
max = [1, 0.4]
"""
MUD = (
    'rheology = "herschel_bulkley"\nyield_stress = 100\nconsistency = 1\nflow_index = 1\n'
    "regularisation = 100\nviscosity_max = 1000"
)
GRAINS = (
    'rheology = "mu_i"\nmu_s = 0.38\nmu_2 = 0.64\ninertial_number = 0.279\n'
    "grain_diameter = 1e-3\ngrain_density = 2500\nviscosity_max = 1000"
)


@pytest.fixture
def said(tmp_path):
    """What is said of a fluid on a rough bed."""

    def sentences(fluid, *settings, more="", across=4.0):
        file = tmp_path / "case.toml"
        file.write_text(SCENARIO.format(fluid=fluid) + more)
        return [str(one) for one in rheology_findings(load_scenario(file, settings), across)]

    return sentences


@pytest.mark.parametrize(
    ("fluid", "turbulence", "told"),
    [
        (MUD, "mixing_length", True),
        (GRAINS, "smagorinsky", True),
        ("nu = 0.02", "mixing_length", True),
        ("nu = 1e-6", "mixing_length", False),
        (MUD, "none", False),
    ],
)
def test_a_viscous_fluid_on_a_rough_wall_with_eddies(said, fluid, turbulence, told):
    found = said(fluid, f"turbulence={turbulence}")
    assert bool(found) == told
    if told:
        assert "body.bed.wall" in found[0]
        assert 'set turbulence = "none"' in found[0]


def test_a_thin_liquid_on_a_rough_wall_without_eddies(said):
    (found,) = said("nu = 1e-6", across=10)
    assert found.startswith('body.bed.wall = "rough" has the friction of a turbulent stream')
    assert "the lowest of 10 particles" in found
    assert 'set turbulence = "mixing_length"' in found
    assert said("nu = 1e-6", across=4) == []
    assert said("nu = 0.02", across=10) == said(MUD, across=10) == []
    assert said("nu = 1e-6", "turbulence=mixing_length", across=10) == []


def test_grains_whose_greatest_viscosity_leaves_no_friction(said):
    """0.38 times 980 Pa, over half of 3 m/s and 0.2 m, makes 49.7 Pa s."""
    thin, falls = GRAINS.replace("= 1000", "= 0.45"), "gravity=[0, -9.8]"
    (found,) = said(thin, falls, across=10)
    assert found.startswith("material.fluid.viscosity_max = 0.45 Pa s is less than a hundredth of")
    assert "the 49.7 Pa s" in found
    assert said(GRAINS.replace("= 1000", "= 0.5"), falls, across=10) == []
    assert said(thin + "\npore_pressure_ratio = 0.5", falls, across=10) == []


def test_grains_under_water(said):
    assert said(GRAINS) == []
    assert "material.fluid.rheology" in said(GRAINS, more=WATER_ABOVE)[0]
    assert said(MUD, more=WATER_ABOVE) == []


WHEEL = """
[body.wheel]
shape = "disc"
material = "basalt"
centre = [0.5, 0.1]
radius = 0.05
"""
DRUM = """
[body.drum]
shape = "box"
material = "basalt"
fixed = true
min = [1.1, 0]
max = [1.2, 0.1]
motion = { angular_velocity = 2, pivot = [1, 0] }
"""


@pytest.mark.parametrize(("more", "name"), [(WHEEL, "wheel"), (DRUM, "drum")])
def test_what_turns_in_a_liquid_with_the_form_of_morris(said, more, name):
    assert said(GRAINS) == []
    (found,) = said(GRAINS, more=more)
    assert found.startswith(f'body.{name}: fluid has viscosity = "morris" (the default here)')
    assert "0.84 times the rate" in found
    assert 'set viscosity = "stress"' in found
    assert said(GRAINS, "viscosity=stress", more=more) == []
    assert said(MUD, more=more) == []
    (found,) = said(MUD, "viscosity=morris", more=more)
    assert "default" not in found
    still = more.replace("angular_velocity = 2, pivot = [1, 0]", "velocity = [1, 0]")
    assert bool(said(GRAINS, more=still)) == (name == "wheel")


def test_suction_of_another_liquid(said):
    sucks = "air_entry_suction = 5000"
    assert said(sucks) == []
    (found,) = said(sucks, more=WATER_ABOVE)
    assert found.startswith("material.water.air_entry_suction = 0 Pa")
    assert "5000 Pa, the suction of fluid" in found
    assert said(sucks, "material.water.air_entry_suction=5000", more=WATER_ABOVE) == []
