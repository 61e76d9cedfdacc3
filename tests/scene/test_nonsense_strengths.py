"""Strengths with which nothing can be computed are refused by name, with what would do."""

from __future__ import annotations

import re

import pytest

from doseki.assess.preflight import check_scenario
from doseki.cli.main import main
from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene

DISC = """
dim = 2
dp = 0.02
scheme = "resolved"
speed_max = 5
time_max = 1
time_out = 1
gravity = [0, 0]
[material.clay]
law = "solid"
rho0 = 1000
young_modulus = 1e6
poisson_ratio = 0.3
fracture = "{fracture}"
{keys}
[body.disc]
shape = "disc"
material = "clay"
kinematics = "elastic"
centre = [0, 0]
radius = 0.1
{more}
"""
COHESIVE = "tensile_strength = {strength}\nfracture_energy = {energy}"
FLAWS = "weibull_k = {k}\nweibull_m = {m}"


@pytest.fixture
def scene(tmp_path):
    """Builds a scene with a disc of 0.0314 m2 that breaks."""

    def build(fracture, keys, more=""):
        text = DISC.format(fracture=fracture, keys=keys, more=more)
        (tmp_path / "disc.toml").write_text(text, encoding="utf-8")
        return build_scene(load_scenario(str(tmp_path / "disc.toml")))

    return build


def cohesive(strength, energy):
    return "cohesive", COHESIVE.format(strength=strength, energy=energy)


def flaws(k, m):
    return "grady_kipp", FLAWS.format(k=k, m=m)


def test_energies_with_which_bonds_snap_back_are_refused(scene):
    """The energy and the spacing that are advised would do."""
    with pytest.raises(UserError) as refused:
        scene(*cohesive(2e4, 1.0))
    said = str(refused.value)
    assert re.search(r"disc\.toml, line \d+: material\.clay\.fracture_energy = 1 J/m2", said), said
    energy = re.search(r"(\S+) J/m2 would do", said)[1]
    dp = re.search(r"or dp = (\S+)$", said)[1]
    assert energy == "1.6"
    scene(*cohesive(2e4, energy))
    scene(*cohesive(2e4, 1.0), f"dp = {dp}")


def test_the_spacing_is_that_of_the_body(scene):
    scene(*cohesive(2e4, 1.6))
    with pytest.raises(UserError, match=r"spacings of body\.disc \(dp = 0\.025 m\)"):
        scene(*cohesive(2e4, 1.6), "dp = 0.025")


def test_strengths_above_a_tenth_of_the_modulus_are_refused(scene):
    scene(*cohesive(1e5, 1e3))
    with pytest.raises(UserError, match=r"material\.clay\.tensile_strength = 1\.1e\+05 Pa.*1e\+05"):
        scene(*cohesive(1.1e5, 1e3))


@pytest.mark.parametrize(
    ("k", "m", "said", "advised"),
    [
        (1e3, 5, r"strain \(k V\)\^\(-1/m\) = 0\.5, above 0\.1: never", r"at least (\S+) 1/m3"),
        (1e90, 10, r"= 1\.4e-09, below 1e-08: it would be dust", r"at most (\S+) 1/m3"),
    ],
)
def test_flaws_that_never_give_way_or_all_do_are_refused(scene, k, m, said, advised):
    with pytest.raises(UserError, match=r"material\.clay\.weibull_k.*body\.disc.*" + said) as error:
        scene(*flaws(k, m))
    scene(*flaws(re.search(advised, str(error.value))[1], m))


def test_no_number_of_flaws_is_advised_that_is_none(scene):
    with pytest.raises(UserError, match="make weibull_m smaller"):
        scene(*flaws(1e90, 99.0))


def test_usual_flaws_are_left_alone(scene):
    scene(*flaws(5e34, 8.5))


ROCK = """
[material.rock]
preset = "basalt"
[material.other]
based_on = "rock"
"""


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ([], 0),
        (["material.rock.weibull_m=8"], 1),
        (["material.other.weibull_k=1e34"], 1),
        (["material.rock.weibull_m=8", "material.rock.weibull_k=1e34"], 0),
        (["material.rock.fracture=none"], 0),
    ],
)
def test_half_of_what_is_fitted_together_is_told(tmp_path, given, told):
    fracture, keys = flaws(5e34, 8.5)
    text = DISC.format(fracture=fracture, keys=keys, more=ROCK)
    (tmp_path / "disc.toml").write_text(text, encoding="utf-8")
    scenario = load_scenario(tmp_path / "disc.toml", given)
    lines = check_scenario(scenario).splitlines()
    said = [line for line in lines if "fitted together" in line]
    assert len(said) == told
    for key in [each.split("=")[0].split(".") for each in given[:told]]:
        assert said[0].startswith(f"warning: material.{key[1]}: {key[2]} is given without weibull_")
        values = [scenario.materials[key[1]].of_laws[k] for k in ("weibull_k", "weibull_m")]
        assert "weibull_k = {:.3g} and weibull_m = {:.3g}".format(*values) in said[0]


def test_the_exit_code_is_that_of_a_mistake_of_the_user(tmp_path, capsys):
    fracture, keys = cohesive(2e4, 1e-9)
    text = DISC.format(fracture=fracture, keys=keys, more="")
    (tmp_path / "disc.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["check", str(tmp_path / "disc.toml")])
    assert ended.value.code == 2
    assert "fracture_energy" in capsys.readouterr().err
