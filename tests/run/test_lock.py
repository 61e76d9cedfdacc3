"""Two runs never write into one folder: the second is told who is there, and touches nothing."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from doseki.errors import UserError
from doseki.record.lock import FolderLock, holder_of
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from .channel import assert_same_record, command, doseki_command, environment, run_channel

HOLD = """\
import sys, time
from doseki.record.lock import FolderLock
FolderLock(sys.argv[1]).take()
print("held", flush=True)
time.sleep(600)
"""


def contents(folder: Path) -> dict[Path, tuple[bytes, int]]:
    """What is in a folder, and when it was written."""
    files = [file for file in folder.rglob("*") if file.is_file()]
    return {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in files}


@pytest.fixture
def holder():
    """Starts a process that holds a folder until it is killed."""
    processes = []

    def hold(folder: Path) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", HOLD, str(folder)],
            env=environment(),
            stdout=subprocess.PIPE,
            text=True,
        )
        processes.append(process)
        assert process.stdout.readline() == "held\n"
        return process

    yield hold
    for process in processes:
        process.kill()
        process.communicate()


@pytest.fixture
def stopped(channel_file, tmp_path):
    """The folder of a run that was stopped on its way."""
    folder = tmp_path / "run"
    run_channel(channel_file, folder, progress=lambda *_: (folder / "STOP").touch())
    return folder


@pytest.mark.parametrize(
    "words", [("resume",), ("run", "--overwrite"), ("run",)], ids=lambda words: " ".join(words)
)
def test_the_second_comer_is_refused_and_touches_nothing(channel_file, stopped, holder, words):
    process = holder(stopped)
    before = contents(stopped)
    first = [channel_file, "-o", stopped] if words[0] == "run" else [stopped]
    done = doseki_command(words[0], *first, *words[1:], "--threads", 1, "--no-figures")
    assert done.returncode == 2, done.stderr
    assert f"process {process.pid} on {socket.gethostname()} is writing here" in done.stderr
    assert contents(stopped) == before


def test_of_two_at_once_one_runs(channel_file, uninterrupted, tmp_path):
    words = command("run", channel_file, "-o", tmp_path / "run", "--threads", 1, "--no-figures")
    options = {"env": environment(), "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    both = [subprocess.Popen(words, text=True, **options) for _ in range(2)]
    said = [process.communicate()[1] for process in both]
    codes = [process.returncode for process in both]
    assert sorted(codes) == [0, 2], said
    # One that is slow may come when the other is done.
    refusal = said[codes.index(2)]
    assert "is writing here" in refusal or "exists and is not empty" in refusal
    assert_same_record(tmp_path / "run", uninterrupted)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["run"]


def test_the_lock_of_a_killed_holder_never_blocks(stopped, holder, uninterrupted):
    process = holder(stopped)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert (stopped / "lock").is_file()
    assert holder_of(stopped) is None
    resume_run(stopped, (), RunOptions(threads=1))
    assert_same_record(stopped, uninterrupted)
    assert not (stopped / "lock").exists()


def test_a_folder_is_held_before_the_scene_is_made(channel_file, holder, tmp_path):
    process = holder(tmp_path / "new" / "run")
    with pytest.raises(UserError, match=f"process {process.pid} on"):
        run_scenario(load_scenario(channel_file), tmp_path / "new" / "run")
    assert not (tmp_path / "new" / "run").exists()


def test_nothing_is_left_where_no_run_has_begun(tmp_path):
    lock = FolderLock(tmp_path / "new" / "run")
    lock.take()
    assert list((tmp_path / "new").iterdir()) != []
    lock.release()
    assert list(tmp_path.iterdir()) == []


def test_a_lock_is_no_way_out_of_the_folder(stopped, tmp_path):
    (tmp_path / "mine").write_text("mine")
    (stopped / "lock").symlink_to(tmp_path / "mine")
    with pytest.raises(UserError):
        resume_run(stopped)
    (stopped / "lock").unlink()
    os.mkfifo(stopped / "lock")
    with pytest.raises(UserError, match="not a regular file"):
        resume_run(stopped)
    assert (tmp_path / "mine").read_text() == "mine"
