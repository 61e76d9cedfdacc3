"""Runs of breakable bodies: the account closes and bits stay, dry, in water and over a map."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.trust.ledger import ledger_of
from doseki.assess.trust.report import trust_checks
from doseki.record.history import BODY_ENERGIES, BROKEN
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from ..small_scenarios import CHALK
from ..terrain.scenes import grid, profile
from .accounts import gap, recorded, without

HEAD = """
schema = 1
dim = {dim}
dp = {dp}
scheme = "resolved"
speed_max = 6
time_max = {time}
time_out = {out}
time_history = 0.00008
gravity = {gravity}
"""
DROP = """
[body.disc]
shape = "disc"
material = "chalk"
kinematics = "breakable"
centre = [0, 0.0525]
radius = 0.05
velocity = [{sign}1, {down}]

[body.waits]
shape = "disc"
material = "chalk"
kinematics = "breakable"
centre = [0.3, 0.1]
radius = 0.05

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.12, -0.02]
max = [0.12, 0]
"""
STRONG = CHALK.replace("1e5", "5e5").replace("fracture_energy = 1\n", "fracture_energy = 25\n")
POOL = """
[body.water]
shape = "box"
material = "water"
min = [-0.15, 0]
max = [0.15, 0.2]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.18, -0.03]
max = [0.18, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.18, 0]
max = [-0.15, 0.25]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
min = [0.15, 0]
max = [0.18, 0.25]

[body.disc]
shape = "disc"
material = "chalk"
kinematics = "breakable"
centre = [0, 0.06]
radius = 0.05
velocity = [0, -6]
"""


def drop(folder, sign="", down=-1.8, material=CHALK, threads=1, *settings):
    """A disc that strikes a plate, and another that nothing strikes."""
    head = HEAD.format(dim=2, dp=0.01, time=0.0024, out=0.0012, gravity=[0, -9.81])
    text = head + DROP.format(sign=sign, down=down) + material
    return recorded(folder, text, *settings, threads=threads)


@pytest.fixture(scope="module")
def dropped(tmp_path_factory):
    return drop(tmp_path_factory.mktemp("drop"))


def test_energy_and_momentum_close(dropped):
    assert dropped.history["broken_bonds"][-1] > 20
    assert gap(ledger_of(dropped)) < 0.01
    checks = {check.name: check for check in trust_checks(dropped)}
    assert checks["energy balance"].verdict == "good"
    assert checks["momentum"].value < 1e-9


@pytest.mark.parametrize(
    "name", ["fracture_work", "damping_work", "contact_work", "kinetic_energy"]
)
def test_every_part_of_it_matters(dropped, name):
    assert gap(without(dropped, name)) > 0.02


def test_the_record_follows_each_body_under_one_number(dropped):
    """Bodies 0 and 1 are in every table once, whatever they are; parts come after them."""
    for snapshot in dropped:
        table = snapshot.grains
        assert table["parent"][:2].tolist() == [-1, -1]
        assert (table["parent"][2:] == 0).all()
        assert table["mass"].sum() == pytest.approx(2 * np.pi * 0.05**2 * 1000, rel=1e-12)
    assert dropped[-1].grains["mass"][0] < dropped[0].grains["mass"][0]
    assert dropped[-1].grains["mass"][1] == dropped[0].grains["mass"][1]


def test_vibration_that_is_left_is_in_the_account(tmp_path):
    """A disc that cracks nowhere is rigid again in the end, and the account is closed."""
    damped = ("body.disc.damping=0.5", "time_max=0.02", "time_out=0.02")
    run = drop(tmp_path, "", -1.8, STRONG, 1, *damped)
    history = run.history
    assert history["broken_bonds"][-1] == 0
    assert history["damping_work"][-1] > 0.01 * history["kinetic_energy"][0]
    assert np.diff(history["damping_work"])[-1] == 0  # nothing is deformable any more
    assert gap(ledger_of(run)) < 0.005


@pytest.mark.parametrize("threads", [2, 4])
def test_threads_give_the_same_bits(dropped, tmp_path, threads):
    again = drop(tmp_path, threads=threads)
    for key in ("position", "velocity", "damage", "grain"):
        assert np.array_equal(again[-1][key], dropped[-1][key]), key
    for name in (*BODY_ENERGIES, *BROKEN, "contact_work"):
        assert np.array_equal(again.history[name], dropped.history[name]), name


def test_the_account_goes_on_from_a_checkpoint(dropped, tmp_path):
    drop(tmp_path, "", -1.8, CHALK, 1, "time_max=0.0012")
    resume_run(tmp_path / "run", ["time_max=0.0024"], RunOptions(threads=1))
    again = load(tmp_path / "run")
    for name in (*BODY_ENERGIES, *BROKEN, "contact_work"):
        assert again.history[name][-1] == dropped.history[name][-1], name


def test_a_mirrored_drop_has_the_same_account(tmp_path):
    """Until it shatters, which tells the sides of the disc apart by rounding."""
    short = ("time_max=0.0018", "time_out=0.0018")
    left, right = (drop(tmp_path / s, s, -1.8, CHALK, 1, *short).history for s in ("-", "+"))
    assert right["fracture_work"][-1] > 0.01
    for name in ("elastic_energy", "fracture_work", "damping_work"):
        np.testing.assert_allclose(left[name], right[name], rtol=0.01, atol=1e-9)


def test_it_breaks_in_water(tmp_path):
    """On the floor of a pool; water and bodies together keep the account."""
    head = HEAD.format(dim=2, dp=0.01, time=0.012, out=0.012, gravity=[0, -9.81])
    head += "cflnumber = 0.2\n"  # what water does to elastic bodies has an error of the step
    run = recorded(tmp_path, head + POOL + CHALK)
    history = run.history
    assert history["broken_bonds"][0] == 0
    assert history["broken_bonds"][-1] > 20
    assert gap(ledger_of(run)) < 0.004
    again = recorded(tmp_path / "again", head + POOL + CHALK, threads=2)
    for key in ("position", "velocity", "pressure", "damage"):
        assert np.array_equal(again[-1][key], run[-1][key]), key


MAP = """
[terrain]
file = "{file}"
material = "aluminium"

[body.ball]
shape = "{shape}"
material = "chalk"
kinematics = "breakable"
centre = {centre}
radius = 0.05
velocity = {velocity}
"""


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kinematics", ["breakable", "elastic"])
def test_it_breaks_on_a_map(tmp_path, dim, kinematics):
    """Where it falls on a slope, and slides on; the account is closed."""

    def height(x, y=0.0):
        return 1.0 - 0.3 * x + 0.0 * y

    file = "map.csv" if dim == 2 else "map.asc"
    if dim == 2:
        profile(tmp_path / file, height, high=2.0)
    else:
        grid(tmp_path / file, height, size=(2.0, 2.0))
    rise = 0.058 * np.sqrt(1 + 0.3**2)
    top = float(height(1.0) + rise)
    centre = [1.0, top] if dim == 2 else [1.0, 1.0, top]
    velocity = [0.5, -3.0] if dim == 2 else [0.5, 0.0, -3.0]
    gravity = [0, -9.81] if dim == 2 else [0, 0, -9.81]
    text = HEAD.format(dim=dim, dp=0.0125, time=0.006, out=0.006, gravity=gravity)
    text += MAP.format(
        file=file, shape="disc" if dim == 2 else "sphere", centre=centre, velocity=velocity
    )
    run = recorded(tmp_path, text.replace("breakable", kinematics) + CHALK)
    assert run.history["broken_bonds"][-1] > 20
    assert run.history["momentum_x"][-1] > run.history["momentum_x"][0]
    assert gap(ledger_of(run)) < 0.01


DAM = """
[body.sill]
shape = "box"
material = "concrete"
kinematics = "elastic"
min = [0, -0.06]
max = [0.1, 0.2]
clamped = "= -y"

[body.boulder]
shape = "disc"
material = "boulder"
kinematics = "{kinematics}"
centre = [-0.0605, 0.14]
radius = 0.06
velocity = [{speed}, 0]

[material.concrete]
law = "solid"
rho0 = 2300
young_modulus = 1e9
poisson_ratio = 0.2
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 50

[material.boulder]
law = "solid"
rho0 = 2600
young_modulus = 2e9
poisson_ratio = 0.2
{fracture}
"""
SILL = """
[terrain]
file = "{file}"
material = "aluminium"

[body.sill]
shape = "box"
material = "concrete"
kinematics = "elastic"
min = {low}
max = {high}
clamped = "= 1 - 0.3*x - {up}"

[material.concrete]
preset = "concrete"
"""
BOULDER = """
[body.boulder]
shape = "{shape}"
material = "aluminium"
centre = {centre}
radius = 0.1
velocity = {velocity}
"""


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("speed", "breaks"), [(0.05, False), (12.0, True), (12.5, True)])
def test_a_sill_stands_in_the_ground_until_a_boulder_strikes_it(tmp_path, dim, speed, breaks):
    """The ground does not press on what is held in it, points just above the clamp among them."""

    def height(x, y=0.0):
        return 1.0 - 0.3 * x + 0.0 * y

    across = [0.7, 1.3] if dim == 3 else []
    if dim == 2:
        profile(tmp_path / "map.csv", height, high=2.0)
    else:
        grid(tmp_path / "map.asc", height, size=(2.0, 2.0))
    head = HEAD.format(dim=dim, dp=0.04, time=0.004, out=0.004, gravity=[0.0] * (dim - 1) + [-9.81])
    text = head + SILL.format(
        file="map.csv" if dim == 2 else "map.asc",
        low=[1.0, *across[:1], 0.52],
        high=[1.4, *across[1:], 1.0],
        up="y" if dim == 2 else "z",
    )
    text += BOULDER.format(
        shape="disc" if dim == 2 else "sphere",
        centre=[0.8995, *([1.0] if dim == 3 else []), 0.88],
        velocity=[speed, *([0.0] if dim == 3 else []), 0.0],
    )
    run = recorded(tmp_path, text)
    history = run.history
    assert gap(ledger_of(run)) < 0.01
    assert history["contact_work"].max() < 1e-3 * history["kinetic_energy"][0]
    assert (history["broken_bonds"][-1] > (20 if breaks else 0)) == breaks


ROCK = 'fracture = "cohesive"\ntensile_strength = 1e7\nfracture_energy = 1000'


@pytest.mark.parametrize(("kinematics", "fracture"), [("rigid", ""), ("breakable", ROCK)])
def test_a_boulder_breaks_the_sill_of_a_dam(tmp_path, kinematics, fracture):
    """The sill is held in its foundation; a slow boulder (the control) leaves it whole."""
    head = HEAD.format(dim=2, dp=0.01, time=0.006, out=0.006, gravity=[0, -9.81])
    broken = {}
    for speed in (0.2, 6):
        text = head + DAM.format(speed=speed, kinematics=kinematics, fracture=fracture)
        run = recorded(tmp_path / str(speed), text)
        broken[speed] = run.history["broken_bonds"][-1]
        assert run.history["momentum_x"][-1] < run.history["momentum_x"][0]
        assert gap(ledger_of(run)) < 0.01
    assert broken[0.2] == 0
    assert broken[6] > 20
