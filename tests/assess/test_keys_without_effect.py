"""Keys of materials that contacts with deformable bodies do not have are named before a run."""

from __future__ import annotations

import pytest

from doseki.assess.warnings import findings
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

from ..small_scenarios import CHALK

SCENE = """\
dim = 2
dp = 0.01
time_max = 0.1
time_out = 0.1
scheme = "resolved"
speed_max = 5
gravity = [0, -9.81]
[contact]
speed = {speed}
[material.stone]
based_on = "basalt"
{stone}
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.5, -0.05]
max = [0.5, 0]
[body.slab]
shape = "box"
material = "chalk"
kinematics = "{kind}"
min = [-0.4, 0]
max = [0.4, 0.1]
[body.disc]
shape = "disc"
material = "stone"
centre = [0, 0.15]
radius = 0.05
"""
PACKING = """
[body.grains]
shape = "disc"
material = "stone"
d = 0.06
count = 5
min = [-0.4, 0.2]
max = [0.4, 0.4]
"""
ROLLS = "rolling_friction = 0.3"
# sigma_t/(rho0 c_P) of chalk, with c_P^2 = E (1 - nu)/(rho0 (1 + nu)(1 - 2 nu)).
WAKES = 1e5 / (1000 * (1e8 / 1000 * 0.8 / (1.2 * 0.6)) ** 0.5)


@pytest.fixture
def told(tmp_path):
    """What is said of keys without effect; `chalk` are lines of the material of the slab."""

    def find(stone="", chalk="", kind="elastic", speed=5.0, more=""):
        text = SCENE.format(stone=stone, kind=kind, speed=speed) + more + CHALK + chalk
        (tmp_path / "case.toml").write_text(text, encoding="utf-8")
        scenario = load_scenario(str(tmp_path / "case.toml"))
        simulation, *about = filled_simulation(scenario)
        simulation.start()
        said = map(str, findings(scenario, simulation.state(), *about))
        return [text for text in said if "has no effect" in text]

    return find


def test_what_is_not_given_or_missing_anyway_is_not_told(told):
    assert told() == []
    assert told(stone="rolling_friction = 0\nrestitution = 1", chalk="rolling_friction = 0") == []


def test_each_key_is_named_with_what_acts_instead(told):
    (said,) = told(chalk="restitution = 0.3")
    assert said.startswith("material.chalk.restitution = 0.3 has no effect where bodies touch slab")
    assert "body.slab.damping" in said
    assert "Eq. 139a" not in said
    (said,) = told(stone=ROLLS)
    assert said.startswith("material.stone.rolling_friction = 0.3 has no effect where bodies")


def test_a_material_that_is_based_on_another_has_its_keys(told):
    based = "[material.flint]\nbased_on = 'stone'\n"
    body = "[body.other]\nshape = 'disc'\nmaterial = 'flint'\ncentre = [0.2, 0.15]\nradius = 0.05\n"
    said = told(stone=ROLLS, more=based + body)
    assert [text.split()[0] for text in said] == ["material.stone.rolling_friction"]


def test_breakable_bodies_are_named_from_the_speed_on_that_wakes_them(told):
    assert told(stone=ROLLS, kind="breakable", speed=0.9 * WAKES) == []
    (said,) = told(stone=ROLLS, kind="breakable", speed=1.1 * WAKES)
    assert f"while it deforms (struck faster than {WAKES:.2g} m/s, Eq. 139a)" in said


def test_grains_that_touch_one_another_keep_their_keys(told):
    assert told(stone=ROLLS, more=PACKING) == []
    assert told(chalk="restitution = 0.3", more=PACKING) != []
