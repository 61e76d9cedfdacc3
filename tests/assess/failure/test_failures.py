"""Scenarios that blow up: the report names the particle, the cause and what to change."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.assess.failure.failure import explanation
from doseki.compiled import load_core
from doseki.driver import rewind
from doseki.driver.checkpoint import CheckpointFolder, from_bytes
from doseki.driver.ranks import OneRank
from doseki.errors import PhysicsError, UserError
from doseki.record.folder import RunFolder
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

OVERLAPPING = """
[body.other]
shape = "box"
material = "basalt"
min = [0.041, 0.0412]
max = [0.121, 0.1212]
"""
LID = """
[body.lid]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.03, 0.08]
max = [0.11, 0.11]
"""
THICKENING = """
scheme = "resolved"
gravity = [0, -9.81]

[material.paste]
based_on = "water"
rheology = "herschel_bulkley"
yield_stress = 0
regularisation = 1
consistency = 1e-20
flow_index = 20
viscosity_max = 1e12

[body.block]
shape = "box"
material = "paste"
min = [0, 0.03]
max = [0.05, 0.08]
velocity = [0, -1]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
normal = [0, 1]
min = [-0.1, -0.04]
max = [0.2, 0]
"""
LONG_STEPS = ("cflnumber=1", "cfl_force=1")


def assert_complete(failed, kind):
    """The parts that every report has."""
    report = failed.report
    assert report["kind"] == kind
    assert report["particle"]["material"] == "basalt"
    assert len(report["particle"]["position"]) == 2
    assert list(failed.error.position) == report["became"]["position"]
    assert report["neighbours"][0]["distance"] <= report["neighbours"][1]["distance"]
    assert report["advice"] in failed.paragraph
    assert report["advice"] in str(failed.error)
    assert (failed.error.kind, failed.error.particle) == (kind, report["particle"]["id"])
    assert f"article {report['particle']['id']} (basalt" in failed.paragraph
    assert failed.run.summary["status"] == "failed"
    said = failed.run.folder.summary_text.read_text()
    assert "status            failed" in said
    assert failed.run.summary["failure"] in said


def assert_stopped_within_one_step(failed):
    """The last good state is that of the step before, whole, and resumable."""
    report, folder = failed.report, failed.run.folder
    assert report["good_state"] is not None
    file = folder.checkpoints / report["good_state"]
    checkpoint = from_bytes(file.read_bytes(), file)
    assert checkpoint.step == report["step"] == failed.run.summary["step"]
    for name, values in checkpoint.state.items():
        assert np.isfinite(values).all(), name
    assert report["particle"]["position"] != report["became"]["position"]
    last = failed.run[-1]
    assert last.time == report["time"] == checkpoint.time
    assert np.isfinite(last["velocity"]).all()
    assert set(report["acceleration"]) == {
        "pressure",
        "deviatoric_stress",
        "artificial_viscosity",
        "gravity",
    }
    assert report["largest_term"] in report["acceleration"]
    assert report["limited_by"] in report["timestep"]


def test_overlapping_bodies(fail, block):
    failed = fail(block + "velocity = [3, 3]\n" + OVERLAPPING, *LONG_STEPS)
    assert_complete(failed, "density")
    assert_stopped_within_one_step(failed)
    assert "do not overlap: block overlaps other" in failed.report["advice"]


def test_overlapping_bodies_whose_names_are_of_several_words(fail, block):
    tables = (block + "velocity = [3, 3]\n" + OVERLAPPING).replace(
        "body.block", 'body."left block"'
    )
    failed = fail(tables, *LONG_STEPS)
    assert "do not overlap: left block overlaps other" in failed.report["advice"]


def test_timestep_forced_too_long(fail, block):
    failed = fail(block + "velocity = [0, 3]\n" + LID, *LONG_STEPS)
    assert_complete(failed, "density")
    assert_stopped_within_one_step(failed)
    assert "Lower cflnumber from 1 to 0.1" in failed.report["advice"]


def test_absurd_velocity(fail, block):
    failed = fail(block + "velocity = [1e5, 0]\n")
    assert_complete(failed, "speed")
    assert_stopped_within_one_step(failed)
    assert failed.report["step"] == 0
    assert "Lower the velocity of body block, 1e+05 m/s" in failed.report["advice"]


def test_fast_impact_on_too_soft_matter(fail, block):
    """Not absurd by itself, but far above the reduced sound speed."""
    failed = fail(block + "velocity = [0, 100]\n" + LID, *LONG_STEPS)
    assert_complete(failed, "density")
    assert "Set xi = 3.3 (now 0.05)" in failed.report["advice"]


def test_a_density_near_zero(fail, tmp_path):
    (tmp_path / "p.csv").write_text(
        "x,y,vx,vy,mass,density,material\n"
        "0,0,0,0,0.2,2750,basalt\n0,0.01,0,0,0.2,2750,basalt\n0.01,0,0,0,0.2,1e-3,basalt\n"
    )
    failed = fail('[body.grains]\nshape = "file"\nfile = "p.csv"\n')
    assert_complete(failed, "density")
    assert failed.report["particle"]["id"] == 2
    assert "Correct the density of body grains: 0.001 kg/m3" in failed.report["advice"]
    assert len(failed.run) == 1


def test_a_particle_far_outside_the_domain(fail, block):
    tables = block + "velocity = [0, -50]\n"
    settings = ("domain_min=[-0.1,-0.1]", "domain_max=[0.2,0.2]")
    failed = fail(tables, *settings)
    assert_complete(failed, "outside")
    assert_stopped_within_one_step(failed)


def test_a_liquid_that_thickens_is_stopped_by_its_viscosity(fail):
    """Its viscosity rises with a high power of the rate of shear, which is none until it lands."""
    # How far the viscosity has come when it stops depends on the step.
    failed = fail(THICKENING, "speed_max=1", "time_max=0.1", "cflnumber=0.3")
    assert failed.report["kind"] == "timestep"
    assert failed.report["limited_by"] == "the viscosity"
    limits = failed.report["timestep"]
    assert limits["the viscosity"] < 1e-2 * limits["the sound speed"]
    assert "its timestep was limited by the viscosity" in failed.paragraph


def test_everything_left(fail, block):
    gone = '\n[outflow.all]\nmin = ["-inf", "-inf"]\nmax = ["inf", -0.05]\n'
    failed = fail(block + "velocity = [0, -20]\n" + gone)
    assert failed.report["kind"] == "empty"
    assert "Check the outflows" in failed.paragraph


def test_a_failed_run_goes_on_after_a_change(fail, block, monkeypatch):
    """The remedy of the report, from a state well before the failure: that of the start."""
    monkeypatch.setattr(rewind, "SECONDS", np.inf)  # a slow machine makes no later copy
    failed = fail(block + "velocity = [0, 3]\n" + LID, *LONG_STEPS, "time_max=0.006")
    folder = failed.run.directory
    settings = ["cflnumber=0.1", "cfl_force=0.1"]
    summary, _ = resume_run(folder, settings, RunOptions(threads=1), until=0.0)
    assert summary["status"] == "done"
    assert not (folder / "failure.json").exists()


def test_a_run_that_did_not_fail_has_nothing_to_explain(run_folder):
    with pytest.raises(UserError, match="has not failed: it came to its end"):
        explanation(RunFolder(run_folder))


@pytest.mark.parametrize(
    ("summary", "words"),
    [
        ({"status": "stopped", "stopped_by": "SIGINT"}, "has not failed: it was stopped by SIGINT"),
        (None, "killed, or memory or disk ran out"),
    ],
)
def test_a_run_that_ended_early_is_told_of(tmp_path, record_run, summary, words):
    recorder, _ = record_run(tmp_path / "run")
    if summary:
        recorder.close(summary)
    told = explanation(RunFolder(tmp_path / "run"))
    assert words in told
    assert "doseki resume" in told


def test_a_run_that_is_going_on_is_called_that(tmp_path, record_run):
    record_run(tmp_path / "run")
    with OneRank().holding(tmp_path / "run"), pytest.raises(UserError, match="it is going on"):
        explanation(RunFolder(tmp_path / "run"))


def test_good_states_are_checkpoints(fail, block):
    failed = fail(block + "velocity = [0, 3]\n" + LID, *LONG_STEPS)
    newest = CheckpointFolder(failed.run.folder.checkpoints).files()[-1]
    assert newest.name == failed.report["good_state"]


SOFT = ("across=20", "young=1e6", "tensile=1e5", "energy=50", "density=2000")  # squeezed flat


def soft_disc(folder):
    """A run that fails in a step in which dust is born; its failure and failure.json."""
    scenario = load_scenario("brazil-test", list(SOFT))
    with pytest.raises(PhysicsError) as failed:
        run_scenario(scenario, folder / "run", RunOptions(threads=1))
    return str(failed.value), json.loads(RunFolder(folder / "run").failure.read_text())


def test_a_run_that_fails_while_dust_is_born_goes_back_to_the_step_before(tmp_path):
    """Its particles were bound to bodies that the state before does not have, at 1e243 m."""
    message, report = soft_disc(tmp_path)
    assert "lost its shape" in message
    assert "step 1:" not in message
    assert "outflow" not in message
    assert "raise young_modulus or contact.speed" in message
    assert report["step"] > 10
    assert report["good_state"]
    times = [snapshot.time for snapshot in load(tmp_path / "run")]
    assert times == sorted(times)
    assert times[-1] == pytest.approx(report["time"])


def test_a_failure_on_the_way_back_leaves_the_first_one(tmp_path, monkeypatch):
    def fails(*_, **__):
        raise load_core().PhysicsFailure("another failure")

    def back_to(self, simulation, step, limit_at):
        simulation.restore(self.last.state)
        return real(self, Stuck(simulation), step, limit_at)

    class Stuck:
        def __init__(self, simulation):
            self.steps, self.time, self.restore = 0, 0.0, simulation.restore

        advance = fails

    real = rewind.Rewind.back_to
    monkeypatch.setattr(rewind.Rewind, "back_to", back_to)
    monkeypatch.setattr(rewind, "SECONDS", 1e9)  # the only copy is that of the start
    message, report = soft_disc(tmp_path)
    assert "lost its shape" in message
    assert "another" not in message
    assert report["step"] > 10
    assert report["good_state"] is None
    times = [snapshot.time for snapshot in load(tmp_path / "run")]
    assert times == sorted(times)
