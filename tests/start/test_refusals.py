"""What a run that starts from another one refuses, in a sentence, and files that mean harm."""

from __future__ import annotations

import shutil

import h5py
import numpy as np
import pytest

from doseki.errors import UserError
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

from .tank import continued, tank_text

TANK = tank_text()


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["start.time=0.5"], r"time = 0.5 s is outside the record of .* from 0 to 0.03 s"),
        (["time_max=0.02"], r"time_max = 0.02 s has passed: the run starts at 0.03 s"),
        (["dp=0.01"], r"dp = 0.01 cannot change: the run that this one starts from has 0.02"),
        (["speed_max=4"], r"xi = .* cannot change"),
        (["scheme=ueta2022"], r"scheme"),
        (["body.water.max=[0.3, 0.1]"], r"water.max cannot change: .* of another name"),
        (["body.one.radius=0.03"], r"body.one.radius cannot change"),
        (["material.rubber.rho0=1000"], r"material.rubber.rho0 = 1000.* cannot change: .* 1100"),
        (["body.two.enabled=false"], r'\[body.two\] of the earlier run is missing: .*"two"'),
        (["start.without=['nobody']"], r'start.without: the earlier run has no "nobody"; it has'),
        (["start.without=['two']"], r'"two" is left out, but \[body.two\] is there'),
        (["start.from=nowhere"], r"start.from: nowhere: no such folder"),
        (["start.from=3"], r"start.from"),
        (["start.from=['a', 'b', 'c', 'd']"], r"from is the folder of a run, or a list"),
        (["start.from=['a', 'b']"], r"start.from: b: no such file"),
        (["start.form=x"], r"start.form is not a known key, did you mean|start.form"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_in_a_sentence(later, settings, said):
    with pytest.raises(UserError, match=said):
        load_scenario(later(), settings)


def test_a_motion_may_change_only_from_the_start_on(later):
    text = TANK.replace("angular_velocity = 8", "angular_velocity = 9")
    with pytest.raises(UserError, match=r"body.paddle cannot carry over: its fixed particles"):
        filled_simulation(load_scenario(later(text=text)))
    later_on = TANK.replace("pivot = [-0.06, 0.06] }", "pivot = [-0.06, 0.06], stop = 0.03 }")
    filled_simulation(load_scenario(later(text=later_on)))


def put(name, values, row=None):
    """A change of a file: a dataset in place of another, or a row of it."""

    def change(file):
        if row is not None:
            file[name][row] = values
            return
        del file[name]
        if values is not None:
            file[name] = values

    return change


HOSTILE = {
    "nan": (
        put("VTKHDF/Points", np.nan, (3, 0)),
        r"line \d+: start.from: .*000003.vtkhdf: the "
        "position of particle 3 is not finite: the snapshot is damaged",
    ),
    "no mass": (put("VTKHDF/PointData/Mass", 0.0, 0), "the mass of particle 0 is not above 0"),
    "fewer": (put("VTKHDF/PointData/Density", np.ones(3)), "must hold"),
    "body": (put("VTKHDF/PointData/Body", 77, 0), "index is outside"),
    "a link": (put("VTKHDF/PointData/Mass", h5py.ExternalLink("x.h5", "/y")), "is a link"),
    "no grains": (put("Grains", None), '"Grains" is missing'),
    "turned": (put("Grains/Orientation", 7.0, (0, 0)), "is no quaternion"),
    "larger": (put("Grains/Diameter", 7.0, 0), "bodies of another size"),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_hostile_snapshot_is_refused(tank, later, tmp_path, kind):
    change, said = HOSTILE[kind]
    shutil.copytree(tank.directory, tmp_path / "hostile")
    with h5py.File(sorted((tmp_path / "hostile/snapshots").iterdir())[-1], "r+") as file:
        change(file)
    with pytest.raises(UserError, match=said):
        filled_simulation(load_scenario(later(folder=tmp_path / "hostile")))


def test_a_scenario_of_the_earlier_run_that_was_changed_by_hand_is_told(tank, later, tmp_path):
    shutil.copytree(tank.directory, tmp_path / "changed")
    file = tmp_path / "changed/scenario.toml"
    assert load_scenario(later(folder=file.parent)).earlier.findings == []
    file.write_text(file.read_text().replace("[material", "# another one\n[material", 1))
    (told,) = load_scenario(later(folder=file.parent)).earlier.findings
    assert f"start.from: {file}: has been changed by hand since the run wrote it" in str(told)


def test_a_damaged_checkpoint_leaves_the_snapshot(tank, later, tmp_path):
    shutil.copytree(tank.directory, tmp_path / "hostile")
    for file in (tmp_path / "hostile/checkpoints").iterdir():
        file.write_bytes(file.read_bytes()[:-1])
    summary = run_scenario(
        load_scenario(later(folder=tmp_path / "hostile"), ["time_max=0.031"]),
        tmp_path / "out",
        RunOptions(threads=1),
    )
    assert any(
        "checkpoint cannot be used (its checksum is wrong)" in w for w in summary["warnings"]
    )


def test_a_run_is_not_replaced_by_what_starts_from_it(tank, tmp_path):
    shutil.copytree(tank.directory, tmp_path / "mine")
    before = sorted(tmp_path.glob("mine/**/*"))
    file = tmp_path / "again.toml"
    file.write_text(continued(TANK.replace("time_max = 0.03", "time_max = 0.05"), "mine"))
    with pytest.raises(UserError, match="is in the folder that is to be overwritten"):
        run_scenario(load_scenario(file), tmp_path / "mine", RunOptions(overwrite=True))
    assert {*before} <= {*tmp_path.glob("mine/**/*")}
