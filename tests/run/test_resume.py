"""A resumed run leaves the record of one that was never interrupted, bit for bit."""

from __future__ import annotations

import shutil

import pytest

from doseki.cli.simulate import resume
from doseki.driver.checkpoint import CheckpointFolder
from doseki.errors import UserError
from doseki.record.reader import load
from doseki.running import progress, runner
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import (
    assert_same_record,
    channel_text,
    doseki_command,
    record,
    run_channel,
)

INTERRUPTIONS = (0.0101, 0.0207, 0.0209, 0.0455)  # s: before, during and after the inflow


def stop_at(directory, time):
    """A progress function that asks the run in `directory` to stop, from `time` on."""
    return lambda now, _dt, _step: (directory / "STOP").touch() if now >= time else None


def interrupted(file, directory, times=INTERRUPTIONS):
    """Run, stopping at each of `times` and resuming."""
    options = {"checkpoint_every": 0.001}
    summary = run_channel(file, directory, progress=stop_at(directory, times[0]), **options)
    for time in times[1:]:
        assert summary["status"] == "stopped"
        progress = stop_at(directory, time)
        summary, _ = resume_run(directory, (), RunOptions(1, progress=progress, **options))
    assert summary["status"] == "stopped"
    return resume_run(directory, (), RunOptions(threads=1))[0]


def test_stop_and_resume(channel_file, uninterrupted, tmp_path):
    summary = interrupted(channel_file, tmp_path / "run")
    assert summary["status"] == "done"
    assert_same_record(tmp_path / "run", uninterrupted)
    expected = load(uninterrupted).summary
    for name in ("step", "av_dissipation", "mass_entered", "mass_left", "neighbour_rebuilds"):
        assert summary[name] == expected[name], name


POOL = """
dim = 2
dp = 0.02
time_max = 0.02
time_out = 0.01
speed_max = 2
gravity = [0, -9.81]
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.2, 0.2]
[outflow.end]
min = [-1, -1]
max = [0.05, 1]
"""


def test_what_was_known_at_the_start_stays_with_the_run(tmp_path):
    """Warnings about the scene, and the key by which its sound speed was given."""
    (tmp_path / "pool.toml").write_text(POOL)
    whole = run_channel(tmp_path / "pool.toml", tmp_path / "whole")
    progress = stop_at(tmp_path / "run", 0.005)
    run_channel(tmp_path / "pool.toml", tmp_path / "run", progress=progress)
    summary, _ = resume_run(tmp_path / "run", (), RunOptions(threads=1))
    assert summary["sound_speed_from"] == whole["sound_speed_from"] == {"speed_max": 2.0}
    assert any("outflow.end" in warning for warning in summary["warnings"])
    assert summary["warnings"] == whole["warnings"]


def test_records_are_looked_through_only_for_gauges_that_need_it(tmp_path, monkeypatch):
    """A run without a gauge of kind approach does not load its record to judge sections."""
    monkeypatch.setattr(runner, "_of_gauges", lambda _directory: ["looked at"])
    (tmp_path / "pool.toml").write_text(POOL)
    assert "looked at" not in run_channel(tmp_path / "pool.toml", tmp_path / "run")["warnings"]


@pytest.mark.minutes
@pytest.mark.parametrize(
    ("dim", "precision", "h_mode"),
    [
        (2, "mixed", "constant"),
        (2, "double", "eq10"),
        (3, "double", "constant"),
        (3, "mixed", "eq10"),
    ],
)
def test_every_mode_resumes_to_the_same_bits(tmp_path, dim, precision, h_mode):
    (tmp_path / "channel.toml").write_text(channel_text(dim, precision, h_mode))
    run_channel(tmp_path / "channel.toml", tmp_path / "straight")
    interrupted(tmp_path / "channel.toml", tmp_path / "run")
    assert_same_record(tmp_path / "run", tmp_path / "straight")


def test_periodic_scenario_resumes_to_the_same_bits(tmp_path):
    settings = ("time_max=0.2",)
    run_channel("film", tmp_path / "straight", *settings)
    progress = stop_at(tmp_path / "run", 0.113)
    run_channel("film", tmp_path / "run", *settings, progress=progress, checkpoint_every=0.004)
    resume_run(tmp_path / "run", (), RunOptions(threads=1))
    assert_same_record(tmp_path / "run", tmp_path / "straight")


@pytest.mark.minutes
def test_threads_may_change_between_the_parts(channel_file, uninterrupted, tmp_path):
    run_channel(
        channel_file,
        tmp_path / "run",
        threads=2,
        progress=stop_at(tmp_path / "run", 0.02),
        checkpoint_every=0.001,
    )
    resume_run(tmp_path / "run", (), RunOptions(threads=1))
    assert_same_record(tmp_path / "run", uninterrupted)


@pytest.mark.minutes
def test_writing_checkpoints_changes_no_bit(channel_file, uninterrupted, tmp_path):
    run_channel(channel_file, tmp_path / "run", checkpoint_every=1e-4, checkpoint_minutes=0.0)
    assert_same_record(tmp_path / "run", uninterrupted)


def test_the_last_two_checkpoints_are_kept(channel_file, tmp_path):
    run_channel(channel_file, tmp_path / "run", checkpoint_every=0.01)
    files = CheckpointFolder(tmp_path / "run/checkpoints").files()
    assert len(files) == 2
    assert sorted((tmp_path / "run/checkpoints").iterdir()) == files


def test_resume_on_the_command_line(channel_file, uninterrupted, tmp_path):
    run_channel(channel_file, tmp_path / "run", progress=stop_at(tmp_path / "run", 0.02))
    done = doseki_command("resume", tmp_path / "run", "--threads", 1)
    said = [line for line in done.stderr.splitlines() if "cores are not" not in line]
    assert (done.returncode, said) == (0, [])
    assert "status            done" in done.stdout
    assert_same_record(tmp_path / "run", uninterrupted)


@pytest.mark.parametrize(("until", "told"), [(0.5, True), (0.02, False), (float("inf"), False)])
def test_a_time_that_the_run_did_not_come_to_is_told(channel_file, tmp_path, until, told):
    run_channel(channel_file, tmp_path / "run", progress=stop_at(tmp_path / "run", 0.02))
    reached = load(tmp_path / "run").times[-1]
    _, notes = resume_run(tmp_path / "run", (), RunOptions(threads=1), until)
    assert bool(notes) == told
    if told:
        start = f"--from 0.5: the run has come to {reached:g} s; it goes on from its last check"
        assert notes[0].startswith(start)


def test_a_run_that_dies_in_its_first_steps_goes_on(channel_file, uninterrupted, tmp_path):
    def die(*_moment):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_channel(channel_file, tmp_path / "run", progress=die)
    resume_run(tmp_path / "run", (), RunOptions(threads=1))
    assert_same_record(tmp_path / "run", uninterrupted)


def test_progress_is_towards_the_new_end(channel_file, tmp_path, monkeypatch):
    run_channel(channel_file, tmp_path / "run")
    ends, bar = [], progress.progress_bar
    monkeypatch.setattr(
        progress, "progress_bar", lambda *given: ends.append(given[1]) or bar(*given)
    )
    resume(tmp_path / "run", settings=["time_max=0.08"], threads=1, figures=False)
    assert ends == [0.08]


def test_resume_further(channel_file, tmp_path):
    run_channel(channel_file, tmp_path / "run")
    resume_run(tmp_path / "run", ["time_max=0.08"], RunOptions(threads=1))
    run = load(tmp_path / "run")
    expected = [
        0,
        0.007,
        0.014,
        0.021,
        0.028,
        0.035,
        0.042,
        0.049,
        0.056,
        0.06,
        0.063,
        0.07,
        0.077,
        0.08,
    ]
    assert run.times == pytest.approx(expected)
    assert run.scenario["time_max"] == 0.08
    assert (sorted(run.history["time"]) == run.history["time"]).all()


def test_a_run_has_its_summary_for_people(uninterrupted):
    text = (uninterrupted / "summary.txt").read_text()
    assert "status            done" in text
    assert "trust" in text


@pytest.mark.parametrize("missing", [("summary.txt",), ("summary.txt", "trust.json")])
def test_reports_that_an_ended_run_did_not_come_to_are_written(uninterrupted, tmp_path, missing):
    folder = tmp_path / "run"
    shutil.copytree(uninterrupted, folder)
    for name in missing:
        (folder / name).unlink()
    before = record(folder)
    summary, _ = resume_run(folder)
    assert summary["status"] == "done"
    assert record(folder) == before
    for name in missing:
        assert (folder / name).read_text() == (uninterrupted / name).read_text()
    with pytest.raises(UserError, match=r"reached time_max"):
        resume_run(folder)


def test_a_stop_at_the_last_step_is_no_stop(channel_file, uninterrupted, tmp_path):
    progress = stop_at(tmp_path / "run", 0.06)
    assert run_channel(channel_file, tmp_path / "run", progress=progress)["status"] == "done"
    assert_same_record(tmp_path / "run", uninterrupted)


def test_a_finished_run_says_how_to_go_further(uninterrupted):
    before = record(uninterrupted)
    with pytest.raises(UserError, match=r"reached time_max.*--set time_max.*doseki plot"):
        resume_run(uninterrupted)
    assert record(uninterrupted) == before


@pytest.mark.parametrize("setting", ["dp=0.02", "time_out=0.001", "xi=0.1", "precision=float"])
def test_what_the_state_was_made_with_cannot_change(uninterrupted, setting):
    with pytest.raises(UserError, match="cannot change when a run is resumed"):
        resume_run(uninterrupted, [setting, "time_max=1"])


def test_a_run_that_ended_and_has_no_checkpoint_is_refused(uninterrupted, tmp_path):
    (tmp_path / "snapshots").mkdir()
    for name in ("scenario.toml", "summary.json"):
        (tmp_path / name).write_bytes((uninterrupted / name).read_bytes())
    with pytest.raises(UserError, match="no whole checkpoint"):
        resume_run(tmp_path)
