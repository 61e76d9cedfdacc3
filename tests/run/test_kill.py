"""A run that is killed at any moment can be loaded, and goes on to the same bits."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from doseki.driver.checkpoint import CheckpointFolder
from doseki.record.reader import load

from .channel import assert_same_record, command, doseki_command, environment

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
    assert ended.returncode in (0, -signal.SIGKILL), ended.stderr
    return ended.returncode != 0


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
        has_checkpoint = bool(CheckpointFolder(folder / "checkpoints").files())
        started = ["resume", folder] if has_checkpoint else ["run", channel_file, "-o", folder]
        overwrite = [] if has_checkpoint or not folder.exists() else ["--overwrite"]
        if kill(generator, folder, [*started, *overwrite, *SETTINGS]):
            done += 1
            load_everything(folder)
        else:
            restart(folder)
    if not CheckpointFolder(folder / "checkpoints").files():
        done = doseki_command("run", channel_file, "-o", folder, "--overwrite", *SETTINGS)
        assert done.returncode == 0, done.stderr
        return
    done = doseki_command("resume", folder, *SETTINGS)
    # The last kill may have come between the end of the run and that of its process.
    assert done.returncode == 0 or "has reached time_max" in done.stderr, done.stderr


def restart(folder):
    """The run came to its end: take away what it ended with."""
    for file in CheckpointFolder(folder / "checkpoints").files():
        file.unlink()


def load_everything(folder):
    """What is on the disk can be read, whenever the run was killed."""
    if not (folder / "snapshots").is_dir() or not (folder / "scenario.toml").exists():
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
