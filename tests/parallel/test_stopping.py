"""Signals to a command that has started its ranks: they end in order, and leave none behind."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from .conftest import SECONDS, environment
from .test_faults import CASE, rank_process, wait_until


def words(folder: Path) -> list[str]:
    run = ["run", "collision", "--ranks", "2", "-o", str(folder), *CASE, "--set", "time_max=99"]
    return [sys.executable, "-m", "doseki.cli.main", *run]


def heard() -> None:
    """What a child process calls: it does not ignore what its parents do."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def marked(mark: Path) -> list[int]:
    """The processes that are left of a test."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if f"DOSEKI_TEST={mark}".encode() in (entry / "environ").read_bytes().split(b"\0"):
                found.append(int(entry.name))
        except (OSError, ValueError):
            continue
    return found


@pytest.fixture
def started(launcher, tmp_path):
    """A run on two ranks in the folder "run", started by itself, that steps."""
    with (tmp_path / "said").open("w") as said:
        process = subprocess.Popen(
            words(tmp_path / "run"),
            env=environment(DOSEKI_TEST=str(tmp_path)),
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=said,
            start_new_session=True,
            preexec_fn=heard,
        )
    wait_until(lambda: list((tmp_path / "run").glob("checkpoints/*.h5")) or process.poll())
    yield process
    for left in marked(tmp_path):
        os.kill(left, signal.SIGKILL)
    process.wait()


def assert_gone(mark: Path) -> None:
    assert rank_process(str(mark), 1) == 0
    wait_until(lambda: not marked(mark))  # the watchdog, too, which sees the others end


def assert_stopped(folder: Path, code: int) -> None:
    assert code == 0
    assert json.loads((folder / "summary.json").read_text())["status"] == "stopped"
    assert int(max((folder / "checkpoints").glob("*.h5")).stem) > 0
    assert not (folder / "failure.json").exists()


def to_group(process):
    os.killpg(process.pid, signal.SIGINT)


def to_starter(number):
    return lambda process: process.send_signal(number)


def as_timeout(process):
    """Twice in no time, as `timeout` sends what it sends."""
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGINT)


WAYS = {
    "interrupted group": to_group,
    "terminated": to_starter(signal.SIGTERM),
    "interrupted": pytest.param(to_starter(signal.SIGINT), marks=pytest.mark.ranks),
    "hung up": pytest.param(to_starter(signal.SIGHUP), marks=pytest.mark.ranks),
    "timed out": pytest.param(as_timeout, marks=pytest.mark.ranks),
}


@pytest.mark.parametrize("stop", WAYS.values(), ids=WAYS)
def test_what_stops_the_starter_stops_its_ranks_in_order(started, tmp_path, stop):
    stop(started)
    code = started.wait(SECONDS)
    assert_gone(tmp_path)
    assert_stopped(tmp_path / "run", code)
    assert "Ctrl-C" not in (tmp_path / "said").read_text()


def test_a_second_interrupt_ends_all_at_once(started, tmp_path):
    ranks = [rank_process(str(tmp_path), rank) for rank in range(2)]
    assert all(ranks)  # a signal to 0 would be one to the tests themselves
    for rank in ranks:  # so that they cannot end in order
        os.kill(rank, signal.SIGSTOP)
    started.send_signal(signal.SIGINT)
    time.sleep(1)
    assert started.poll() is None
    started.send_signal(signal.SIGINT)
    assert started.wait(SECONDS) == 130
    assert (tmp_path / "said").read_text().endswith("doseki: interrupted\n")
    assert_gone(tmp_path)


@pytest.mark.ranks
@pytest.mark.skipif(sys.platform != "linux", reason="the system cannot tell of a parent's end")
def test_a_starter_that_is_killed_leaves_no_ranks(started, tmp_path):
    started.kill()
    assert started.wait(SECONDS) == -signal.SIGKILL
    wait_until(lambda: not marked(tmp_path))
    assert_stopped(tmp_path / "run", 0)


@pytest.mark.ranks
def test_ctrl_c_on_a_terminal_stops_in_order(launcher, tmp_path):
    process, terminal = pty.fork()
    if process == 0:
        heard()
        os.execve(sys.executable, words(tmp_path / "run"), environment(DOSEKI_TEST=str(tmp_path)))
    wait_until(lambda: list((tmp_path / "run").glob("checkpoints/*.h5")))
    os.write(terminal, b"\x03")
    said = b""
    while True:
        try:
            said += os.read(terminal, 65536)
        except OSError:  # all have closed it
            break
    code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    assert_gone(tmp_path)
    assert_stopped(tmp_path / "run", code)


DEAF = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); {} time.sleep(900)"
SAYS = "from doseki.parallel.starter import say_listening; say_listening();"
STARTER = """
import sys
from doseki.errors import Interrupted
from doseki.parallel.starter import Starter
try:
    Starter().run([sys.executable, "-c", sys.argv[1]])
except Interrupted:
    sys.exit(130)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("listening", [False, True])
def test_a_launcher_that_passes_nothing_on_yet_is_ended(tmp_path, number, listening):
    process = subprocess.Popen(
        [sys.executable, "-c", STARTER, DEAF.format(SAYS if listening else "")],
        env=environment(DOSEKI_TEST=str(tmp_path)),
        preexec_fn=heard,
    )
    wait_until(lambda: len(marked(tmp_path)) > 1)
    time.sleep(1.0)
    process.send_signal(number)
    if listening:  # an order to stop is under way, which takes a while
        time.sleep(1.0)
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
    assert process.wait(SECONDS) == 130
    wait_until(lambda: not marked(tmp_path))


@pytest.mark.parametrize("seconds", [0.0, 0.3])
def test_an_interrupt_while_ranks_start_is_one_line(launcher, tmp_path, seconds):
    mark = environment(DOSEKI_TEST=str(tmp_path))
    process = subprocess.Popen(
        words(tmp_path / "run"), env=mark, stderr=subprocess.PIPE, text=True, preexec_fn=heard
    )
    wait_until(lambda: len(marked(tmp_path)) > 1)
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=SECONDS)[1]
    assert process.returncode == 130
    assert said.splitlines()[-1] == "doseki: interrupted"
    assert_gone(tmp_path)
    assert not (tmp_path / "run").exists()
