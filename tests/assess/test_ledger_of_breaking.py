"""The account of energy closes where a body breaks, and a run says so."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.summary import summary_text
from doseki.assess.trust.ledger import ledger_of
from doseki.assess.trust.report import trust_checks
from doseki.record.history import BODY_ENERGIES, BROKEN
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from ..small_scenarios import CHALK
from .accounts import gap, recorded, without

DROP = """
schema = 1
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 6
time_max = 0.0024
time_out = 0.0012
time_history = 0.00004
gravity = [{sign}2, -9.81]

[body.disc]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [0, 0.0505]
radius = 0.05
velocity = [{sign}1, -1.8]

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.1, -0.02]
max = [0.1, 0]
"""


def drop(folder, sign="", threads=1, *settings):
    """The record of a disc that strikes a plate at an angle and breaks."""
    return recorded(folder, DROP.format(sign=sign) + CHALK, *settings, threads=threads)


@pytest.fixture(scope="module")
def dropped(tmp_path_factory):
    return drop(tmp_path_factory.mktemp("drop"))


def test_energy_and_momentum_close(dropped):
    ledger = ledger_of(dropped)
    assert dropped.history["broken_bonds"][-1] > 50
    assert gap(ledger) < 0.01
    checks = {check.name: check for check in trust_checks(dropped)}
    assert checks["energy balance"].verdict == "good"
    assert checks["momentum"].value < 1e-9
    assert "energy balance" in summary_text(dropped)


@pytest.mark.parametrize("name", [*BODY_ENERGIES, "contact_work", "kinetic_energy"])
def test_every_part_of_it_matters(dropped, name):
    assert gap(without(dropped, name)) > 0.02


def test_what_came_off_is_counted(dropped):
    """As the table of bodies at the end has it; bonds of dust and of parts are broken."""
    table, history = dropped[-1].grains, dropped.history
    of_part = table["parent"] >= 0
    assert history["parts"][-1] + history["dust_grains"][-1] == of_part.sum()
    assert history["dust_grains"][-1] > 0
    for name in ("broken_bonds", "parts", "dust_grains"):
        assert (np.diff(history[name]) >= 0).all()


def test_damage_is_where_bonds_are_broken(dropped):
    first, last = dropped[0], dropped[-1]
    assert not first["damage"].any()
    assert not last["damage"][last["fixed"]].any()
    parts, counts = np.unique(last["grain"][last["grain"] >= 0], return_counts=True)
    single = np.isin(last["grain"], parts[counts == 1])
    assert single.any()
    assert (last["damage"][single] == 1).all()
    assert ((last["damage"] >= 0) & (last["damage"] <= 1)).all()


def test_a_mirrored_drop_has_the_same_account(tmp_path):
    """Until it shatters, which tells the sides of the disc apart by rounding."""
    short = ("time_max=0.0008", "time_out=0.0008")
    left, right = (drop(tmp_path / sign, sign, 1, *short).history for sign in ("-", "+"))
    assert right["fracture_work"][-1] > 0.01
    for name in BODY_ENERGIES:
        np.testing.assert_allclose(left[name], right[name], rtol=0.01, atol=1e-9)


@pytest.mark.parametrize("threads", [2, 4])
def test_threads_give_the_same_bits(dropped, tmp_path, threads):
    again = drop(tmp_path, "", threads)
    for key in ("position", "velocity", "damage", "grain"):
        assert np.array_equal(again[-1][key], dropped[-1][key]), key
    for name in (*BODY_ENERGIES, *BROKEN, "contact_work"):
        assert np.array_equal(again.history[name], dropped.history[name]), name


def test_the_account_goes_on_from_a_checkpoint(dropped, tmp_path):
    drop(tmp_path, "", 1, "time_max=0.0012")
    resume_run(tmp_path / "run", ["time_max=0.0024"], RunOptions(threads=1))
    again = load(tmp_path / "run")
    for name in (*BODY_ENERGIES, *BROKEN, "contact_work"):
        assert again.history[name][-1] == dropped.history[name][-1], name


SOFT = """
schema = 1
dim = 2
dp = 0.004
scheme = "resolved"
speed_max = 10
time_max = 0.002
time_out = 0.002
time_history = 4e-6

[contact]
speed = 20

[body.stone]
kinematics = "elastic"
material = "chalk"
velocity = [0, -6]
rotate = {angle}
{shape}

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.2, -0.02]
max = [0.2, 0]
"""


def square(angle: float) -> str:
    """Of 8 cm on a corner, a tenth of a spacing above the plate."""
    turn = np.radians(angle)
    y = 0.04 * (np.cos(turn) + np.sin(turn)) + 4e-4
    return f'shape = "box"\nmin = [-0.04, {y - 0.04}]\nmax = [0.04, {y + 0.04}]\npivot = [0, {y}]'


DISC = 'shape = "disc"\nradius = 0.04\ncentre = [0, 0.0405]'


@pytest.mark.parametrize(
    ("shape", "angle"), [(DISC, 11), (square(45), 45), (square(15), 15), (square(15), -75)]
)
def test_what_breaks_under_pressure_gains_no_energy(tmp_path, shape, angle):
    """In no step has a body more than contacts gave it: the ledger would close without that."""
    run = recorded(tmp_path, SOFT.format(shape=shape, angle=angle) + CHALK)
    history = run.history
    assert history["broken_bonds"][-1] > 300
    assert history["dust_grains"][-1] > 20
    rise = np.diff(history["kinetic_energy"] + history["elastic_energy"] - history["contact_work"])
    assert rise.max() < 3e-4 * history["kinetic_energy"][0]
    assert rise[rise > 0].sum() < 1e-3 * history["kinetic_energy"][0]


MEET = """
schema = 1
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 60
time_max = 0.0012
time_out = 0.0006
time_history = 0.00004
gravity = [0, 0]

[parameters]
along = {{ value = {along} }}

[body.left]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [-0.0505, 0]
radius = 0.05
velocity = ["= 3 + along", "= along/5"]

[body.right]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [0.0505, 0.01]
radius = 0.05
velocity = ["= -3 + along", "= along/5"]
"""


def test_a_moving_frame_hides_nothing(tmp_path):
    at_rest, carried = (
        recorded(tmp_path / name, MEET.format(along=speed) + CHALK)
        for name, speed in (("at_rest", 0), ("carried", 40))
    )
    assert at_rest.history["broken_bonds"][-1] > 10
    assert carried.history["kinetic_energy"][0] > 100 * at_rest.history["kinetic_energy"][0]
    largest = ledger_of(at_rest).largest
    assert ledger_of(carried).largest == pytest.approx(largest, rel=1e-3)
    assert gap(without(carried, "fracture_work")) == pytest.approx(
        gap(without(at_rest, "fracture_work")), rel=0.3
    )
