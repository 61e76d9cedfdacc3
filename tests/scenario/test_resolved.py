"""Keys of the resolved scheme: what it takes for granted, and what it refuses."""

from __future__ import annotations

import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.walls.normals import wall_geometry

from ..scene.test_wall_geometry import built
from ..small_scenarios import BLOCK

RESOLVED = 'scheme = "resolved"\n'
FAST = RESOLVED + "speed_max = 2"
ROCK = BLOCK.replace("block", "rock").replace("water", "basalt")
WALL = ROCK.replace("min = [0, 0]", "min = [0, -0.5]").replace("[1, 0.5]", "[1, 0]\nfixed = true")


@pytest.mark.parametrize(
    ("top", "tables", "parts"),
    [
        (RESOLVED, BLOCK, ["line 5", "needs the highest speed", "speed_max (m/s)", "xi"]),
        (FAST + '\nprecision = "single"', BLOCK, ["precision = 'single'", "'double'", "'mixed'"]),
        (
            FAST,
            BLOCK + ROCK + "jitter = 0.1\n",
            ["body.rock.jitter", "moves as a whole", "ueta2022"],
        ),
        (FAST, BLOCK + WALL + 'wall = "rough"\n', ["body.rock", "a rough wall needs ks (m)"]),
        (FAST, BLOCK + WALL + 'wall = "slippery"\n', ["body.rock.wall", "'free_slip'", "'rough'"]),
        (FAST, BLOCK + WALL + "ks = 0\n", ["body.rock.ks = 0 is out of range"]),
        (FAST + "\nxi = 0.1", BLOCK, ["xi and speed_max exclude each other"]),
        (FAST + "\nxi_height = 1", BLOCK, ["xi_height and speed_max exclude each other"]),
        (RESOLVED + "speed_max = 0", BLOCK, ["speed_max = 0 is out of range", "greater than 0"]),
        ('kernel = "wendland_c2"', BLOCK, ["line 5", "the scheme ueta2022 has wendland_c6 alone"]),
        ('eos = "tait"', BLOCK, ["line 5", "the scheme ueta2022 has birch_murnaghan alone"]),
        ('scheme = "resolve"', BLOCK, ["scheme = 'resolve' is not allowed", "'resolved'"]),
        (FAST + '\nkernel = "cubic"', BLOCK, ["kernel = 'cubic' is not allowed", "'wendland_c2'"]),
        (FAST + '\neos = "ideal"', BLOCK, ["eos = 'ideal' is not allowed", "'tait'"]),
        (FAST + '\nturbulence = "les"', BLOCK, ["turbulence = 'les'", "'smagorinsky'"]),
        (FAST + '\nviscosity = "x"', BLOCK, ["viscosity = 'x'", "'monaghan_cleary'"]),
        (FAST + "\nsmagorinsky = -1", BLOCK, ["smagorinsky = -1 is out of range", "at least 0"]),
        (FAST + "\nacoustic_damping = 2", BLOCK, ["acoustic_damping = 2 is out of range"]),
        (FAST + "\nshifting = 1", BLOCK, ["shifting = 1 must be true or false"]),
    ],
)
def test_errors(write, error_of, top, tables, parts):
    text = error_of(write(top=top, tables=tables))
    assert all(part in text for part in parts), text


@pytest.mark.parametrize("scale", ["speed_max = 2", "xi = 0.1", "xi_height = 0.3"])
def test_any_way_to_give_the_sound_speed_will_do(write, scale):
    assert load_scenario(write(top=RESOLVED + scale)).xi > 0


def test_speed_max_sets_the_sound_speed_of_the_fluid_alone(write):
    scenario = load_scenario(write(top=FAST, tables=BLOCK + WALL))
    assert scenario.xi * scenario.materials["water"].speedsound == pytest.approx(20)


def test_defaults_are_those_of_the_scheme(write):
    scenario = load_scenario(write(top=FAST))
    assert (scenario.kernel, scenario.eta) == ("wendland_c2", 1.39)
    assert (scenario.cflnumber, scenario.cfl_force) == (0.8, 0.25)
    assert scenario.support == pytest.approx(0.278)
    wide = load_scenario(write(top=FAST + '\nkernel = "wendland_c6"'))
    assert (wide.eta, wide.support) == (1.2, pytest.approx(0.3))
    assert load_scenario(write(top=FAST + "\neta = 1.5")).eta == 1.5
    paper = load_scenario(write())
    assert (paper.kernel, paper.eta, paper.cflnumber) == ("wendland_c6", 1.2, 0.1)


def test_effective_scenario_is_read_back(write, tmp_path):
    scenario = load_scenario(write(top=FAST, tables=BLOCK + WALL + 'wall = "rough"\nks = 0.01\n'))
    (tmp_path / "effective.toml").write_text(scenario.effective_toml())
    again = load_scenario(str(tmp_path / "effective.toml"))
    assert again.effective_toml() == scenario.effective_toml()
    assert (again.scheme, again.kernel, again.xi) == ("resolved", "wendland_c2", scenario.xi)
    assert (again.body["rock"].wall, again.body["rock"].ks) == ("rough", 0.01)


def test_a_wall_of_points_needs_a_normal(write):
    points = '\n[body.p]\nshape = "points"\nmaterial = "basalt"\nfixed = true\nmass = 1\n'
    tables = BLOCK + points + "position = [[0.5, -0.1], [0.6, -0.1]]\n"
    with pytest.raises(UserError, match=r"body\.p: a wall of points needs its normal"):
        wall_geometry(*built(write(top=FAST, tables=tables)))
    normal, depth, _ = wall_geometry(*built(write(top=FAST, tables=tables + "normal = [0, 2]\n")))
    assert normal[-1].tolist() == [0, 1]
    assert depth[-1] == pytest.approx(0.05)
