"""The launcher of MPI as a process that ends with ours: what would stop us stops all ranks."""

from __future__ import annotations

import ctypes
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

from ..driver.schedule import answered
from ..errors import Interrupted

SAME = 0.5  # s within which signals are one: `timeout` sends each to a process and to its group
LAST = 10.0  # s for killed processes to be gone
DEATH_SIGNAL = 1  # of prctl(2): what a process gets when its parent ends
FOLDER = "DOSEKI_STARTER"  # the variable that names the folder in which rank 0 says that it listens
LISTENING = "listening"  # the file that it makes there


def say_listening() -> None:
    """Tell the starter, if there is one on this machine, that all ranks answer signals."""
    if folder := os.environ.get(FOLDER):
        with suppress(OSError):
            (Path(folder) / LISTENING).touch()


class Starter:
    """Starts the launcher, and hands signals on to the ranks.

    The launcher has a session of its own, as a terminal's Ctrl-C would have it kill ranks. SIGTERM
    is what launchers pass on without a word, however often it comes; but one that comes while they
    start processes may reach nobody. Until all ranks listen, signals end everything at once.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._asked: float | None = None  # when the first signal came
        self._killed = False
        self._folder = Path()

    def run(self, command: Sequence[str]) -> int:
        """Carry out a command; its exit code, with which all its processes have ended.

        Raises Interrupted when a second Ctrl-C has killed them, or a signal before they listened.
        """
        ours, theirs = os.pipe()
        try:
            with TemporaryDirectory(prefix="doseki-") as folder, _answering(self._answer):
                self._folder = Path(folder)
                self._start(command, theirs)
                assert self._process is not None
                code = self._process.wait()
                # All that were started hold the other end.
                select.select([ours], [], [], LAST)
        finally:
            os.close(ours)
        if self._killed:
            raise Interrupted
        return code

    def _start(self, command: Sequence[str], pipe: int) -> None:
        try:
            self._process = subprocess.Popen(
                command,
                env=os.environ | {FOLDER: str(self._folder)},
                stdin=subprocess.DEVNULL,
                start_new_session=True,
                pass_fds=[pipe],
                preexec_fn=_with_parent(),
            )
        finally:
            os.close(pipe)
        if self._asked is not None:  # meanwhile
            self._kill()

    def _answer(self, number: int, _frame: FrameType | None) -> None:
        now = time.monotonic()
        again = self._asked is not None and now - self._asked > SAME
        doubled = self._asked is not None and not again
        self._asked = now if self._asked is None else self._asked
        if self._process is None or doubled:
            return
        if (number == signal.SIGINT and again) or not (self._folder / LISTENING).exists():
            self._kill()
        else:
            self._process.send_signal(signal.SIGTERM)

    def _kill(self) -> None:
        assert self._process is not None
        self._killed = True
        self._process.kill()


@contextmanager
def _answering(answer: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Let `answer` answer what ends a run."""
    old = {number: signal.signal(number, answer) for number in answered()}
    try:
        yield
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)


def _with_parent() -> Callable[[], object] | None:
    """What lets a new process get SIGTERM should ours be killed, where the system can do that."""
    if sys.platform != "linux":
        return None
    prctl = ctypes.CDLL(None).prctl
    return lambda: prctl(DEATH_SIGNAL, int(signal.SIGTERM), 0, 0, 0)
