"""Runs of a study on this machine: a process each, so many at once."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress

from ...util.cores import allowed_cores
from .folder import RunPlace, StudyFolder

POLL = 0.05  # s
GRACE = 20.0  # s in which runs end with a checkpoint when the study does

Finished = Callable[[RunPlace, str], None]  # with the reason where no row was written


class LocalRuns:
    """Starts a process for each run; a run that dies takes no other one with it."""

    def __init__(self, folder: StudyFolder, threads: int, at_once: int | None) -> None:
        """By default as many at once as there are cores for their threads."""
        self._folder, self._threads = folder, threads
        self.at_once = at_once or max(1, allowed_cores() // threads)

    def carry_out(self, places: Sequence[RunPlace], finished: Finished) -> None:
        """Run all; `finished` is called as each ends. A file STOP lets no other one start."""
        waiting = list(reversed(places))
        going: dict[RunPlace, subprocess.Popen[bytes]] = {}
        try:
            while going or (waiting and not self._folder.stop.exists()):
                while waiting and len(going) < self.at_once and not self._folder.stop.exists():
                    place = waiting.pop()
                    going[place] = self._start(place)
                self._reap(going, finished)
        finally:
            _end(going.values())

    def _start(self, place: RunPlace) -> subprocess.Popen[bytes]:
        command = [
            sys.executable, "-m", "doseki.studies.runs.one_run",
            str(self._folder.path), place.path.name,
        ]  # fmt: skip
        threads = str(self._threads)
        limits = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), threads)
        with place.output.open("wb") as output:
            # Its own session: Ctrl-C ends the study, which then ends its runs in good order.
            return subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=output, stderr=output,
                env=os.environ | limits, start_new_session=True,
            )  # fmt: skip

    def _reap(self, going: dict[RunPlace, subprocess.Popen[bytes]], finished: Finished) -> None:
        ended = [place for place, process in going.items() if process.poll() is not None]
        for place in ended:
            process = going.pop(place)
            assert process.stdin is not None
            with suppress(OSError):
                process.stdin.close()
            finished(place, _reason(place, process.returncode))
        if not ended:
            time.sleep(POLL)


def _reason(place: RunPlace, code: int) -> str:
    """Why a process ended without a row."""
    if code < 0:
        return f"killed by signal {-code}"
    if not code:
        return "was stopped before its end"
    said = place.output.read_text(errors="replace").strip().splitlines()
    return said[-1] if code and said else f"ended with code {code}"


def _end(processes: object) -> None:
    """End processes in good order; those that take too long at once."""
    left = [p for p in processes if isinstance(p, subprocess.Popen)]  # type: ignore[attr-defined]
    for process in left:
        with suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]
    end = time.monotonic() + GRACE
    for process in left:
        try:
            process.wait(max(0.0, end - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
