"""Bodies that span ranks: rigid grains and an elastic one in water."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import doseki

TANK = """\
dim = 2
scheme = "resolved"
speed_max = 2
dp = 0.01
time_max = 0.02
time_out = 0.01

[material.rubber]
law = "solid"
rho0 = 1100
speedsound = 60
shear_modulus = 1e6

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.03, -0.03]
max = [0.43, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.03, 0]
max = [0, 0.15]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
min = [0.4, 0]
max = [0.43, 0.15]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.1]

[body.stone]
shape = "disc"
material = "basalt"
centre = [0.2, 0.14]
radius = 0.03
velocity = [0, -1]

[body.pebble]
shape = "disc"
material = "basalt"
centre = [0.25, 0.18]
radius = 0.03
velocity = [-1, -1]

[body.plate]
shape = "box"
material = "rubber"
kinematics = "elastic"
min = [0.05, 0.11]
max = [0.15, 0.15]
velocity = [0, -1]

[gauge.stones]
kind = "mass_centre"
bodies = ["stone", "pebble"]

[gauge.path]
kind = "motion"
bodies = ["stone", "pebble"]
interval = 0.005
"""
BODIES = ("stone", "pebble", "plate")


@pytest.fixture(scope="module")
def tank(command, tmp_path_factory):
    """The runs on one and two ranks, and one that is interrupted and resumed on either."""
    folder = tmp_path_factory.mktemp("tank")
    file = folder / "tank.toml"
    file.write_text(TANK)
    words = ["--no-figures", "--threads", 1]
    for ranks in (1, 2):
        done = command(ranks, "run", file, "-o", folder / str(ranks), *words)
        assert done.returncode == 0, done.stderr
    done = command(1, "run", file, "-o", folder / "on 1", *words, "--set", "time_max=0.01")
    assert done.returncode == 0, done.stderr
    shutil.copytree(folder / "on 1", folder / "on 2")
    for ranks in (1, 2):
        halfway = folder / f"on {ranks}"
        done = command(ranks, "resume", halfway, *words, "--set", "time_max=0.02")
        assert done.returncode == 0, done.stderr
    return {name: doseki.load(folder / name) for name in ("1", "2", "on 1", "on 2")}


def test_bodies_move_as_on_one_rank(tank):
    one, two = tank["1"], tank["2"]
    np.testing.assert_array_equal(one.times, two.times)
    for mine, yours in zip(one, two, strict=True):
        np.testing.assert_array_equal(mine["id"], yours["id"])
        for name in ("position", "velocity", "density", "force"):
            scale = np.abs(mine[name]).max(initial=1e-300) if name in mine else 1.0
            if name in mine:
                assert np.abs(mine[name] - yours[name]).max() < 1e-6 * scale, name


def test_mixed_precision_on_two_ranks(command, tmp_path):
    """Ranks share one frame for the places in single precision."""
    (tmp_path / "tank.toml").write_text(TANK)
    words = ["--no-figures", "--threads", 1, "--set", "precision=mixed", "--set", "time_max=0.01"]
    for ranks in (1, 2):
        done = command(ranks, "run", tmp_path / "tank.toml", "-o", tmp_path / str(ranks), *words)
        assert done.returncode == 0, done.stderr
    mine, yours = (doseki.load(tmp_path / ranks)[-1] for ranks in "12")
    for name in ("position", "velocity", "density"):
        difference = np.abs(mine[name] - yours[name]).max()
        assert difference < 1e-3 * np.abs(mine[name]).max(), name


def test_bodies_did_meet_water_and_each_other(tank):
    """Otherwise the test above says little."""
    first, last = tank["1"][0], tank["1"][-1]
    for name in BODIES:
        of_it = first["body"] == name
        before, after = (snapshot["velocity"][of_it].mean(axis=0) for snapshot in (first, last))
        assert np.linalg.norm(after - before) > 0.05, name


def test_the_gauge_of_their_motion_reads_the_same(tank):
    one, two = (tank[ranks].gauges["path"] for ranks in "12")
    assert two["grain"].tolist() == [0, 1] * 5
    for name in one:
        scale = np.nanmax(np.abs(one[name]))
        np.testing.assert_allclose(two[name], one[name], atol=1e-5 * scale, err_msg=name)


def test_bodies_go_on_on_other_ranks(tank):
    mine, yours = tank["on 1"][-1], tank["on 2"][-1]
    assert tank["on 2"].summary["ranks"] == 2
    for name in ("position", "velocity"):
        difference = np.abs(mine[name] - yours[name]).max()
        assert difference < 1e-6 * np.abs(mine[name]).max(), name


def test_energy_and_mass_count_each_body_once(tank):
    one, two = tank["1"].history, tank["2"].history
    for name in ("mass", "kinetic_energy", "shear_energy", "momentum_y"):
        np.testing.assert_allclose(two[name], one[name], rtol=1e-5, atol=1e-8, err_msg=name)


def test_a_centre_of_mass_counts_each_body_once(tank):
    one, two = (tank[name].gauges["stones"] for name in ("1", "2"))
    assert len(one["time"]) == 3
    for name in one:
        np.testing.assert_allclose(two[name], one[name], rtol=1e-5, atol=1e-8, err_msg=name)
    np.testing.assert_allclose(one["mass"], 2 * 2750 * np.pi * 0.03**2)
