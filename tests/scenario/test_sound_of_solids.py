"""Solids that nothing asks for their sound speed need none."""

import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies
from doseki.solver.build import filled_simulation

SCENE = """\
dim = 2
dp = 0.01
scheme = "resolved"
speed_max = 3
time_max = 0.2
time_out = 0.1
gravity = [0, -9.8]
[material.brick]
law = "solid"
rho0 = 1900
[body.floor]
shape = "box"
material = "brick"
fixed = true
min = [-0.5, -0.02]
max = [0.5, 0]
[body.block]
shape = "box"
material = "brick"
min = [0, 0.05]
max = [0.1, 0.15]
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(SCENE)
    return str(path)


def test_rigid_bodies_need_none(scene, tmp_path):
    scenario = load_scenario(scene)
    assert scenario.materials["brick"].rho0 == 1900
    particles, _ = build_bodies(scenario)
    assert len(particles) == 300
    (tmp_path / "again.toml").write_text(scenario.effective_toml())
    again = load_scenario(str(tmp_path / "again.toml"))
    assert again.xi == scenario.xi
    assert again.materials["brick"] == scenario.materials["brick"]


@pytest.mark.parametrize(
    ("override", "part"),
    [
        ("scheme=ueta2022", "speedsound is missing: the scheme ueta2022 computes with it"),
        ("body.block.kinematics=elastic", "speedsound is missing: the stiffness of elastic bodies"),
        ("contact.stiffness=material", "speedsound is missing: the stiffness of contacts"),
        ("material.brick.law=fluid", "needs speedsound"),
    ],
)
def test_what_follows_from_it_is_named(scene, error_of, override, part):
    assert part in error_of(scene, override)


@pytest.mark.parametrize("way", ["contact.stiffness=material", "body.block.kinematics=elastic"])
def test_a_modulus_will_do(scene, way):
    load_scenario(scene, [way, "material.brick.young_modulus=2 GPa"])


def test_what_is_based_on_such_a_solid_has_none_either(scene, error_of, tmp_path):
    more = '[material.stone]\nbased_on = "brick"\nrho0 = 2500\n'
    (tmp_path / "more.toml").write_text(SCENE + more)
    scenario = load_scenario(str(tmp_path / "more.toml"), ["body.block.material=stone"])
    assert not scenario.materials["stone"].has_sound
    given = load_scenario(
        str(tmp_path / "more.toml"),
        ["body.block.material=stone", "material.stone.speedsound=3 km/s"],
    )
    assert given.materials["stone"].has_sound


def test_a_fall_in_steps_as_long_as_outputs_are_apart_ends_on_the_floor(scene):
    simulation, *_ = filled_simulation(load_scenario(scene))
    simulation.start()
    while simulation.time < 0.2:
        simulation.advance(limit=0.2, pause=0.1 if simulation.time < 0.1 else 0.2, max_steps=10**6)
    lowest = simulation.state()["position"][200:, 1].min()
    assert 0.004 < lowest < 0.05
