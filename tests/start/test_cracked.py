"""A run that starts from one whose elastic bodies have cracks."""

from __future__ import annotations

import pytest

from doseki.assess.preflight import preflight
from doseki.errors import UserError
from doseki.record.reader import load
from doseki.running.devices import count_of_scene
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from ..small_scenarios import CHALK

DISC = (
    """
schema = 1
dim = 2
dp = 0.01
scheme = "resolved"
speed_max = 6
time_max = 0.002
time_out = 0.001
gravity = [0, 0]

[body.disc]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [0, 0.06]
radius = 0.05
velocity = [0, -6]

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.2, -0.02]
max = [0.2, 0]
"""
    + CHALK
)
START = """
[start]
from = "earlier"
time = {time}
"""
ADDED = """
[body.wall]
shape = "box"
material = "aluminium"
fixed = true
min = [0.3, 0]
max = [0.32, 0.1]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Holds the record of a disc that is whole after 1 ms and has cracks after 2 ms."""
    folder = tmp_path_factory.mktemp("cracked")
    (folder / "disc.toml").write_text(DISC, encoding="utf-8")
    run_scenario(
        load_scenario(str(folder / "disc.toml")), folder / "earlier", RunOptions(threads=1)
    )
    earlier = load(folder / "earlier")
    assert earlier.at(0.001)["damage"].max() == 0 < earlier.at(0.002)["damage"].max()
    return folder


def later(folder, time: float, more: str):
    """A scenario that starts from the earlier run."""
    text = DISC.replace("time_max = 0.002", "time_max = 0.0022") + START.format(time=time) + more
    (folder / "later.toml").write_text(text, encoding="utf-8")
    return load_scenario(str(folder / "later.toml"))


def started(folder, time: float, more: str):
    """A run from the earlier one."""
    scenario = later(folder, time, more)
    run_scenario(scenario, folder / "later", RunOptions(threads=1, overwrite=True))
    return load(folder / "later")


def test_it_goes_on_with_its_cracks_where_the_bodies_are_the_same(folder):
    broken = load(folder / "earlier").history["broken_bonds"]
    assert started(folder, 0.002, "").history["broken_bonds"][0] == broken[-1] > 0


def test_the_check_begins_as_the_run_does(folder):
    """It takes the checkpoint where the run would, and refuses in the same words."""
    found = preflight(later(folder, 0.002, ""))
    assert found.particles == len(load(folder / "earlier").at(0.002)["id"])
    assert found.steps == 1  # 0.2 ms: those before do not count
    assert count_of_scene(later(folder, 0.002, "")) == found.particles
    with pytest.raises(UserError) as of_check:
        preflight(later(folder, 0.002, ADDED))
    with pytest.raises(UserError) as of_run:
        started(folder, 0.002, ADDED)
    assert str(of_check.value) == str(of_run.value)


def test_both_say_when_a_checkpoint_cannot_be_used(folder):
    """At 1 ms there is one no more, if there was: it is damaged here, and the snapshot does."""
    scenario = later(folder, 0.001, "")
    snapshot = scenario.earlier.snapshot
    broken = folder / "earlier" / "checkpoints" / f"{snapshot.step:012d}.h5"
    broken.write_bytes(b"nothing")
    (said,) = [w for w in preflight(later(folder, 0.001, "")).warnings if "checkpoint" in w]
    assert "cannot be used" in said
    broken.unlink()


def test_a_snapshot_without_the_cracks_is_refused(folder):
    with pytest.raises(UserError, match=r"body.disc cannot carry over: it has cracks"):
        started(folder, 0.002, ADDED)


def test_from_before_the_cracks_it_may_start(folder):
    """The control."""
    run = started(folder, 0.001, ADDED)
    assert run.history["broken_bonds"][0] == 0 < run.history["broken_bonds"][-1]
