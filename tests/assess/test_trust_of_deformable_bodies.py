"""The trust report on runs in which nothing moves but deformable bodies."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.trust.deformable import deformable_checks
from doseki.assess.trust.report import trust_checks
from doseki.assess.trust.snapshots import look
from doseki.assess.trust.verdicts import BAD, GOOD, NOT_AVAILABLE
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario

from ..small_scenarios import CHALK

DISCS = """
schema = 1
dim = 2
dp = 0.02
time_max = 0.08
time_out = 0.02
scheme = "resolved"
speed_max = 2
gravity = [0, -9.81]
[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 50
young_modulus = 1e6
poisson_ratio = 0.3
friction = 0.5
[body.a]
shape = "disc"
material = "rubber"
kinematics = "elastic"
centre = [-0.101, 0.05]
radius = 0.1
velocity = [0.5, 0.1]
spin = 3
{clamp}
[body.b]
shape = "disc"
material = "rubber"
kinematics = "elastic"
centre = [0.101, -0.05]
radius = 0.1
velocity = [-0.5, 0]
"""
NAMES = ("momentum", "energy gained", "angular momentum")


@pytest.fixture
def run(tmp_path):
    """The record of two discs that meet while they fall; `clamp` is a line of the first."""

    def make(clamp=""):
        (tmp_path / "discs.toml").write_text(DISCS.format(clamp=clamp), encoding="utf-8")
        run_scenario(load_scenario(str(tmp_path / "discs.toml")), tmp_path / "run")
        return load(tmp_path / "run")

    return make


def verdicts(checks):
    """The verdict of each check by its name."""
    return {check.name: check.verdict for check in checks}


def test_momenta_and_energy_of_free_discs_are_judged(run):
    record = run()
    found = verdicts(trust_checks(record))
    assert [found[name] for name in NAMES] == [GOOD] * 3
    seen = look(record)
    seen.angular_momentum[-1] = seen.angular_momentum[-1] + np.array([0, 0, 1e-3])
    seen.body_energy[-1] += 20.0  # J/m of as much
    spoilt = verdicts(deformable_checks(record, seen))
    assert spoilt == {"energy gained": BAD, "angular momentum": BAD}


def test_a_clamp_takes_momentum_and_no_energy(run):
    found = verdicts(trust_checks(run('clamped = "= -x - 0.1"')))
    assert [found[name] for name in NAMES] == [NOT_AVAILABLE, GOOD, NOT_AVAILABLE]


STRUCK = """\
dim = 2
dp = 0.01
time_max = 0.02
time_out = 0.002
scheme = "resolved"
speed_max = 5
[contact]
speed = 0.05
[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 50
young_modulus = 1e6
poisson_ratio = 0.3
friction = 0
[material.steel]
based_on = "basalt"
[body.block]
shape = "box"
material = "rubber"
kinematics = "elastic"
min = [-0.1, 0]
max = [0.1, 0.05]
[body.ball]
shape = "disc"
material = "steel"
velocity = [0, -3]
centre = [0, 0.09]
radius = 0.03
"""
OTHERS = """\
[body.left]
shape = "disc"
material = "steel"
centre = [1, 0]
radius = 0.03
velocity = [3, 0]
[body.right]
shape = "disc"
material = "steel"
centre = [1.07, 0]
radius = 0.03
"""


@pytest.mark.parametrize(("others", "found"), [("", GOOD), (OTHERS, BAD)])
def test_contacts_as_stiff_as_a_material_are_not_judged_by_contact_speed(tmp_path, others, found):
    (tmp_path / "ball.toml").write_text(STRUCK + others, encoding="utf-8")
    run_scenario(load_scenario(str(tmp_path / "ball.toml")), tmp_path / "run")
    record = load(tmp_path / "run")
    assert max(snapshot.overlaps().max() for snapshot in record) > 0.02
    (check,) = (each for each in trust_checks(record) if each.name == "overlap of contacts")
    assert check.verdict == found
    if found == BAD:
        assert "raise contact.speed" in check.remedy


BREAKABLE_BALL = """\
dim = 2
dp = 0.01
time_max = 0.008
time_out = 0.001
scheme = "resolved"
speed_max = 5
gravity = [0, 0]
[contact]
speed = 0.2
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.2, -0.05]
max = [0.2, 0]
[body.ball]
shape = "disc"
material = "chalk"
kinematics = "breakable"
velocity = [0, -2]
centre = [0, 0.0501]
radius = 0.05
"""


@pytest.mark.parametrize(("strength", "found"), [(1e7, BAD), (1e3, GOOD)])
def test_breakable_bodies_count_while_they_are_rigid(tmp_path, strength, found):
    """The strong one sinks into the floor as a rigid body does; the weak one deforms at once."""
    text = BREAKABLE_BALL + CHALK
    settings = [f"material.chalk.tensile_strength={strength}", "material.chalk.fracture_energy=1e9"]
    (tmp_path / "ball.toml").write_text(text, encoding="utf-8")
    run_scenario(load_scenario(str(tmp_path / "ball.toml"), settings), tmp_path / "run")
    record = load(tmp_path / "run")
    assert max(snapshot.overlaps().max() for snapshot in record) > 0.011
    (check,) = (each for each in trust_checks(record) if each.name == "overlap of contacts")
    assert check.verdict == found
    if found == BAD:
        assert "raise contact.speed" in check.remedy
