"""A run that is killed at any moment can be loaded, and goes on to the same bits."""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from doseki.record.folder import RunFolder
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import assert_same_record, command, doseki_command, environment, run_channel

EARLY = range(1, 40, 6)  # operations on files: those of the start, some of them
SETTINGS = ("--threads", 1, "--no-figures", "--checkpoint-every", 0.0005)


def kill_at_a_file(generator, folder, arguments):
    """Start doseki and kill -9 it at one of its next operations on files; false if it had fewer."""
    operations = generator.randint(1, 150)
    script = [sys.executable, Path(__file__).parent / "dying.py", operations, folder]
    ended = subprocess.run(
        [str(word) for word in (*script, *arguments)],
        env=environment(),
        capture_output=True,
        check=False,
    )
    # The kill before may have come between the end of the run and that of its process.
    over = b"has reached time_max" in ended.stderr
    assert over or ended.returncode in (0, -signal.SIGKILL), ended.stderr
    return ended.returncode == -signal.SIGKILL


def kill_at_a_time(generator, _folder, arguments):
    """Start doseki and kill -9 it after some time; false if it was done before."""
    # Most of the first second goes into starting Python.
    seconds = generator.uniform(0.5, 2.5)
    run = subprocess.Popen(
        command(*arguments), env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        run.wait(seconds)
    except subprocess.TimeoutExpired:
        run.kill()
        run.wait()
        return True
    return False


def kill_again_and_again(channel_file, folder, kills, kill):
    """Run, and kill, resume, kill ... `kills` times; then go on to the end."""
    generator = random.Random(kills)
    done = 0
    while done < kills:
        started = ["resume", folder] if folder.exists() else ["run", channel_file, "-o", folder]
        if kill(generator, folder, [*started, *SETTINGS]):
            done += 1
            load_everything(folder)
        else:
            restart(folder)
    if not folder.exists():
        doseki_command("run", channel_file, "-o", folder, *SETTINGS)
        return
    done = doseki_command("resume", folder, *SETTINGS)
    # The last kill may have come between the end of the run and that of its process.
    assert done.returncode == 0 or "has reached time_max" in done.stderr, done.stderr


def restart(folder):
    """The run came to its end: take away what it ended with."""
    for file in RunFolder(folder).endings():
        file.unlink()


def load_everything(folder):
    """What is on the disk can be read, whenever the run was killed."""
    if not folder.exists():
        return
    run = load(folder)
    for snapshot in run:
        assert len(snapshot["position"]) > 0
    assert len(run.history.columns) == 0 or len(run.history["time"]) >= 0


@pytest.mark.minutes
def test_killed_five_times(channel_file, uninterrupted, tmp_path):
    kill_again_and_again(channel_file, tmp_path / "run", 5, kill_at_a_file)
    assert_same_record(tmp_path / "run", uninterrupted)


@pytest.mark.full
@pytest.mark.parametrize("kill", [kill_at_a_file, kill_at_a_time])
def test_killed_fifty_times(channel_file, uninterrupted, tmp_path, kill):
    kill_again_and_again(channel_file, tmp_path / "run", 50, kill)
    assert_same_record(tmp_path / "run", uninterrupted)


@pytest.mark.minutes
@pytest.mark.parametrize("overwrite", [False, True])
def test_killed_early_it_can_be_resumed_as_soon_as_there_is_a_folder(
    channel_file, tmp_path, overwrite
):
    """Killed at some of its first operations on files, in a new folder or one of an earlier run."""
    short = "time_max=0.0025"
    run_channel(channel_file, tmp_path / "new", short)
    run_channel(channel_file, tmp_path / "old", "time_max=0.002")
    folders = [tmp_path / f"run-{operations}" for operations in EARLY]
    if overwrite:
        for folder in folders:
            shutil.copytree(tmp_path / "old", folder)
    words = ["run", channel_file, "-o", tmp_path / "run", "--set", short, *SETTINGS]
    words += ["--overwrite"] if overwrite else []
    script = [
        sys.executable,
        Path(__file__).parent / "dying.py",
        f"{EARLY.start}-{EARLY.stop}-{EARLY.step}",
        tmp_path / "run",
    ]
    subprocess.run([str(word) for word in (*script, *words)], env=environment(), check=True)
    there = [folder for folder in folders if folder.exists()]
    assert there[-1] == folders[-1]
    resumed = set()
    for folder in there:
        load_everything(folder)
        # Before anything else goes, an earlier run that is done stays so.
        if not RunFolder(folder).summary.exists():
            resume_run(folder, (), RunOptions(threads=1))
        # Until its scenario is replaced, the earlier run is the one that goes on.
        resumed.add(load(folder).scenario["time_max"])
        assert_same_record(folder, tmp_path / ("new" if 0.0025 in resumed else "old"))
    assert resumed == ({0.002, 0.0025} if overwrite else {0.0025})
