"""The account of energy and momentum closes where water comes and goes, and with a body in it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from doseki.assess.trust.ledger import GIVEN, HELD, RELAXATION, TAKEN, Ledger, ledger_of
from doseki.assess.trust.report import trust_checks
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

TOP = """\
dim = 2
scheme = "resolved"
dp = 0.01
time_max = {time_max}
time_out = 0.1
time_history = 0.01
"""
CHANNEL = (
    TOP.format(time_max=0.5)
    + """\
speed_max = 3
slope = 20

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.005
normal = [0, 1]
min = [-0.4, -0.03]
max = [0.35, 0]

[inflow.water]
material = "water"
rate = 0.06
width = 1
position = [0.2, 0]
direction = [-1, 0]
depth = 0.05
start = 0
duration = 1

[outflow.end]
min = ["-inf", "-inf"]
max = [-0.2, "inf"]
"""
)
TANK = (
    TOP.format(time_max=0.4)
    + """\
speed_max = 1.6
cflnumber = 0.1
gravity = [0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.03, -0.03]
max = [0.33, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
normal = [1, 0]
min = [-0.03, 0]
max = [0, 0.4]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
normal = [-1, 0]
min = [0.3, 0]
max = [0.33, 0.4]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.3, 0.25]

[body.disc]
shape = "disc"
material = "basalt"
radius = 0.04
centre = [0.15, 0.15]
"""
)


def run_of(folder, text):
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    run_scenario(load_scenario(str(folder / "case.toml")), folder / "run", RunOptions(threads=1))
    return load(folder / "run")


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    """Water runs in, down a rough bed, and out."""
    return run_of(tmp_path_factory.mktemp("channel"), CHANNEL)


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    """A stone sinks in a tank."""
    return run_of(tmp_path_factory.mktemp("tank"), TANK)


def checks_of(run):
    return {check.name: check for check in trust_checks(run)}


class WithColumns:
    """A run whose history has other columns."""

    def __init__(self, run, **columns):
        self.scenario = run.scenario
        self.history = {name: run.history[name] for name in run.history} | columns


def without(run, *names):
    """The ledger of a run that had not recorded these columns."""
    zeros = {name: np.zeros(len(run.history["time"])) for name in names}
    return dataclasses.replace(ledger_of(run), run=WithColumns(run, **zeros))


def size(ledger):
    return np.max(np.abs(ledger.energy_residual())) / ledger.largest


def momentum_of(ledger):
    return ledger.momentum_check("", (1e-3, 1e-2)).value


def test_energy_closes_with_inflow_and_outflow(channel):
    """Over a rough bed, whose friction is most of what is dissipated."""
    assert channel.summary["mass_left"] > 5
    assert checks_of(channel)["energy balance"].value < 1e-3


@pytest.mark.parametrize(
    "name",
    [
        "energy_entered",
        "energy_left",
        "gravity_work",
        "wall_work",
        "av_dissipation",
        "scheme_work",
    ],
)
def test_every_part_of_a_channel_matters(channel, name):
    assert size(without(channel, name)) > 0.015


def test_momentum_closes_with_inflow_and_outflow(channel):
    assert checks_of(channel)["momentum"].value < 5e-4
    for name in ("momentum_entered_x", "momentum_left_x", "impulse_x"):
        assert momentum_of(without(channel, name)) > 0.03


def test_a_smooth_wall_is_in_the_account(tmp_path):
    """Its boundary layer is not resolved: it takes energy, and makes none (Eq. 138)."""
    run = run_of(tmp_path, CHANNEL.replace("ks = 0.005\n", "").replace('"rough"', '"no_slip"'))
    assert size(ledger_of(run)) < 0.005
    assert checks_of(run)["energy of corrections"].value < 0.03


def test_a_channel_that_is_mirrored_has_the_same_account(channel, tmp_path):
    text = CHANNEL.replace("slope = 20", "slope = -20")
    for left, right in (
        ("min = [-0.4, -0.03]\nmax = [0.35, 0]", "min = [-0.35, -0.03]\nmax = [0.4, 0]"),
        ("position = [0.2, 0]\ndirection = [-1, 0]", "position = [-0.2, 0]\ndirection = [1, 0]"),
        (
            'min = ["-inf", "-inf"]\nmax = [-0.2, "inf"]',
            'min = [0.2, "-inf"]\nmax = ["inf", "inf"]',
        ),
    ):
        assert left in text
        text = text.replace(left, right)
    mirrored = run_of(tmp_path, text)
    for name in ("gravity_work", "wall_work", "energy_entered", "energy_left"):
        expected = channel.history[name][-1]
        assert mirrored.history[name][-1] == pytest.approx(expected, rel=0.02), name
    expected = -channel.history["impulse_x"][-1]
    assert mirrored.history["impulse_x"][-1] == pytest.approx(expected, rel=0.02)


def test_energy_and_momentum_close_in_a_tank(tmp_path):
    """The water falls into its pressure and rings."""
    found = checks_of(run_of(tmp_path, TANK[: TANK.index("[body.disc]")]))
    assert found["energy balance"].value < 2e-3
    assert found["momentum"].value < 1e-9


def test_energy_and_momentum_close_with_a_body_in_water(tank):
    disc = tank[-1].grains["position"][0]
    assert disc[1] < 0.09  # it has sunk
    assert checks_of(tank)["energy balance"].value < 0.01
    for name in ("contact_work", "scheme_work", "gravity_work", "av_dissipation"):
        assert size(without(tank, name)) > 0.05
    assert checks_of(tank)["momentum"].value < 1e-9
    assert momentum_of(without(tank, "impulse_y")) > 0.005


def test_energy_and_momentum_close_with_a_deformable_body_in_water(tmp_path):
    """A disc of rubber sinks, bends and is pushed about."""
    rubber = """
[material.rubber]
law = "solid"
rho0 = 1500
young_modulus = 2e5
poisson_ratio = 0.3
"""
    text = TANK.replace('material = "basalt"\n', 'material = "rubber"\nkinematics = "elastic"\n')
    text = text.replace("time_max = 0.4", "time_max = 0.2") + rubber
    run = run_of(tmp_path, text)
    assert run.history["elastic_energy"].max() > 0.01
    assert checks_of(run)["energy balance"].value < 0.002
    for name in ("elastic_energy", "gravity_work", "av_dissipation", "scheme_work"):
        assert size(without(run, name)) > 0.02
    assert checks_of(run)["momentum"].value < 1e-9


def test_the_work_of_gravity_is_the_potential_that_was_released(tank):
    height = [snapshot["mass"] @ snapshot["position"][:, 1] for snapshot in tank]
    released = 9.8 * (height[0] - height[-1])
    assert tank.history["gravity_work"][-1] == pytest.approx(released, rel=1e-6)


def test_energy_that_walls_and_relaxation_make_is_told(tank):
    """Eight particles across a stone that falls through three times that: no good run."""
    checks = checks_of(tank)
    assert "good" not in {
        checks[f"energy of {name}"].verdict for name in ("corrections", "relaxation")
    }


@pytest.mark.parametrize(
    ("relaxed", "dissipated", "verdict"),
    [(-0.009, 0.5, "good"), (-0.2, 0.3, "doubtful"), (-0.2, 0.1, "bad"), (0.2, 0.3, "bad")],
)
def test_relaxation_may_take_less_than_viscosity_and_make_nothing(
    tank, relaxed, dissipated, verdict
):
    """Over the work of gravity."""
    rows = np.linspace(0, 1, len(tank.history["time"]))
    still = without(tank, *HELD, *GIVEN, *TAKEN, RELAXATION).run
    columns = {"gravity_work": 1e3 * rows, "av_dissipation": 1e3 * dissipated * rows}
    run = WithColumns(still, **columns, relaxation_work=1e3 * relaxed * rows)
    _others, found = Ledger(run, "").numerical_checks()
    assert (found.name, found.verdict) == ("energy of relaxation", verdict)
    assert found.value == pytest.approx(abs(relaxed))


def test_what_relaxation_takes_is_no_work_of_walls(tank):
    relaxed = tank.history["relaxation_work"]
    assert np.abs(relaxed).max() > 0.005 * tank.history["gravity_work"].max()
    others = checks_of(tank)["energy of corrections"].details["work"]
    assert others == pytest.approx(np.abs(tank.history["scheme_work"] - relaxed).max(), rel=1e-9)


@pytest.mark.parametrize(
    ("spacings", "verdict"), [(0.009, "good"), (0.02, "doubtful"), (0.06, "bad")]
)
def test_water_at_rest_is_judged_by_how_far_it_sinks(tank, spacings, verdict):
    """Nothing else takes part in the energy of a lake, whatever its depth is."""
    still = without(tank, *HELD, *GIVEN, *TAKEN, RELAXATION).run
    weight = 9.8 * tank.history["mass"].max()
    sunk = spacings * tank.scenario["dp"] * weight * np.linspace(0, 1, len(tank.history["time"]))
    for name in ("scheme_work", "relaxation_work"):
        lake = Ledger(WithColumns(still, **{"scheme_work": -sunk, name: -sunk}), "")
        walls, relaxed = lake.numerical_checks()
        assert (walls if name == "scheme_work" else relaxed).verdict == verdict


def test_contacts_take_what_a_bouncing_disc_loses(tmp_path):
    """Without water all of it is theirs, but for what the springs hold."""
    text = TANK.replace("[body.water]", "[body.water]\nenabled = false")
    run = run_of(tmp_path, text.replace("time_max = 0.4", "time_max = 0.5"))
    lost = run.history["contact_work"]
    assert lost[-1] < -0.3 * run.history["gravity_work"].max()
    found = checks_of(run)
    assert found["energy balance"].value < 1e-6
    assert found["momentum"].value < 1e-9


def test_an_account_goes_on_where_it_was(channel, tmp_path):
    (tmp_path / "case.toml").write_text(CHANNEL)
    scenario = load_scenario(str(tmp_path / "case.toml"), ["time_max=0.2"])
    run_scenario(scenario, tmp_path / "run", RunOptions(threads=1))
    resume_run(tmp_path / "run", ["time_max=0.5"], RunOptions(threads=1))
    resumed = load(tmp_path / "run").history
    for name in ("gravity_work", "wall_work", "energy_left", "impulse_x", "scheme_work"):
        assert resumed[name][-1] == channel.history[name][-1], name


def test_where_nothing_moves_rounding_is_no_energy(tank):
    rows = np.arange(len(tank.history["time"]))
    still = dict.fromkeys((*HELD, *GIVEN, *TAKEN), 0.0 * rows)
    for size, verdict in ((1e-22, "good"), (1.0, "bad")):
        run = WithColumns(tank, **still | {"kinetic_energy": size * rows})
        check = dataclasses.replace(ledger_of(tank), run=run).energy_check("energy", (0.01, 0.05))
        assert check.verdict == verdict
