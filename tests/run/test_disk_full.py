"""A full disk ends a run with one message and code 4; what was written before stays readable."""

from __future__ import annotations

import os
import resource
import subprocess
from pathlib import Path

import pytest

from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import assert_same_record, doseki_command


def limit_files_to(size):
    """What a child process must call so that no file of its grows beyond `size` bytes."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def assert_stopped_cleanly(done, folder):
    assert done.returncode == 4, done.stderr
    assert "Traceback" not in done.stderr
    messages = [line for line in done.stderr.splitlines() if line.startswith("doseki:")]
    assert len(messages) == 1
    assert "cannot be written" in messages[0]
    assert "what was written before is whole" in messages[0]
    run = load(folder)
    for snapshot in run:
        assert len(snapshot["position"]) > 0
    assert len(run.history["time"]) > 0
    assert not list(folder.rglob("*.part"))
    told = doseki_command("explain", folder)
    assert told.returncode == 0
    assert "was stopped after step" in told.stdout or "disk ran out" in told.stdout


@pytest.mark.parametrize("size", [100_000, 200_000, 300_000])
def test_a_file_that_does_not_fit(channel_file, tmp_path, size):
    """The history outgrows the limit, or a checkpoint does, or a snapshot."""
    done = doseki_command(
        "run",
        channel_file,
        "-o",
        tmp_path / "run",
        "--threads",
        1,
        "--checkpoint-every",
        0.02,
        "--set",
        "time_history=0.00003",
        "--no-figures",
        preexec_fn=limit_files_to(size),
    )
    assert_stopped_cleanly(done, tmp_path / "run")


@pytest.mark.parametrize("size", [500, 2_000, 12_000, 40_000])
def test_before_the_first_checkpoint(channel_file, uninterrupted, tmp_path, size):
    """The scenario, the first snapshot or the first checkpoint does not fit; later it does."""
    folder = tmp_path / "run"
    words = ("run", channel_file, "-o", folder, "--threads", 1, "--no-figures")
    done = doseki_command(*words, preexec_fn=limit_files_to(size))
    assert done.returncode == 4, done.stderr
    assert "Traceback" not in done.stderr
    assert len([line for line in done.stderr.splitlines() if line.startswith("doseki:")]) == 1
    assert not list(tmp_path.rglob("*.part"))
    assert not list(folder.glob("checkpoints/*.h5"))
    again = ("resume", folder, *words[4:]) if folder.exists() else words
    done = doseki_command(*again)
    assert done.returncode == 0, done.stderr
    assert_same_record(folder, uninterrupted)


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 400 kB, where the test may mount one."""
    if os.geteuid() != 0:
        pytest.skip("mounting a small disk needs root")
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=400k", "doseki-test", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("a small disk cannot be mounted here")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


def test_a_small_disk_fills_up_and_the_run_goes_on_when_there_is_room(
    channel_file, uninterrupted, small_disk: Path
):
    done = doseki_command(
        "run",
        channel_file,
        "-o",
        small_disk / "run",
        "--threads",
        1,
        "--checkpoint-every",
        0.004,
        "--no-figures",
    )
    assert_stopped_cleanly(done, small_disk / "run")
    subprocess.run(["mount", "-o", "remount,size=20m", str(small_disk)], check=True)
    resume_run(small_disk / "run", (), RunOptions(threads=1))
    assert_same_record(small_disk / "run", uninterrupted)
