"""A small process beside rank 0 that outlives the ranks, to say which of them was killed.

A rank that is killed says nothing, and the MPI launcher then kills the others.  The watchdog waits
for the first process of this machine to end, or for the pipe from rank 0 to close.
"""

from __future__ import annotations

import json
import os
import select
import signal
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..record.lock import holder_of
from .rank_failure import RankFailure

GRACE = 2.0  # s between the end of a rank and the report, in which another one may write its own


class Watchdog:
    """The end of the pipe that rank 0 holds.  Start it before MPI and threads: it forks."""

    def __init__(self) -> None:
        read, self._write = os.pipe()
        if os.fork() == 0:
            try:
                os.close(self._write)
                _watch(read)
            finally:
                os._exit(0)
        os.close(read)

    def watch(self, processes: list[int]) -> None:
        """Ids of the processes by rank; 0 for those of other machines."""
        self._send(processes=processes)

    def report_in(self, directory: Path) -> None:
        """The folder of the run."""
        self._send(directory=str(directory.absolute()))

    def dismiss(self) -> None:
        """The ranks are about to end in good order."""
        self._send(dismissed=True)

    def _send(self, **said: Any) -> None:
        # Where nobody watches any more, that is no reason to stop.
        with suppress(OSError):
            os.write(self._write, (json.dumps(said) + "\n").encode())


def _watch(pipe: int) -> None:
    """What the watchdog does."""
    os.setsid()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    _close_all_but(pipe)
    said: dict[str, Any] = {}
    first = _first_to_end(pipe, said)
    if not said.get("dismissed") and "directory" in said:
        select.select([], [], [], GRACE)
        directory = Path(said["directory"])
        holder = holder_of(directory)
        # Another run may have the folder by now.
        if holder is None or holder.pid in said.get("processes", ()):
            RankFailure(first, _cause(first, said)).write(directory)


def _close_all_but(pipe: int) -> None:
    """The launcher waits for whoever holds its pipes."""
    os.closerange(0, pipe)
    os.closerange(pipe + 1, 4096)


def _first_to_end(pipe: int, said: dict[str, Any]) -> int:
    """Collect what rank 0 says until a rank ends; its number, or -1 where that is not known."""
    handles: dict[int, int] = {}
    rest = b""
    while not said.get("dismissed"):
        ready, _, _ = select.select([pipe, *handles], [], [])
        for handle in ready:
            if handle in handles:
                return handles[handle]
        received = os.read(pipe, 65536)
        if not received:
            return -1
        *lines, rest = (rest + received).split(b"\n")
        for line in lines:
            said |= json.loads(line)
        if "processes" in said and not handles:
            handles = _handles(said["processes"])
    return -1


def _handles(processes: list[int]) -> dict[int, int]:
    """Something to wait on for each process of this machine, and its rank."""
    handles = {}
    for rank, process in enumerate(processes):
        if process:
            try:
                handles[os.pidfd_open(process)] = rank
            except OSError:
                continue
    return handles


def _cause(rank: int, said: dict[str, Any]) -> str:
    if rank < 0:
        return "a process ended without a word: killed, or its machine was lost"
    return (
        f"process {said['processes'][rank]} ended without a word:"
        " killed from outside, or out of memory"
    )
