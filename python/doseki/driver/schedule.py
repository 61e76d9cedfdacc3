"""When a run writes checkpoints, and when it is asked to stop."""

from __future__ import annotations

import math
import os
import signal
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import numpy as np

STOP_FILE = "STOP"


class OutputTimes:
    """Multiples of an interval, the last of them exactly at the end of the run."""

    SAME = 1e-12  # relative difference of two times that are meant to be one

    def __init__(self, interval: float, last: float) -> None:
        """Both in s."""
        self.interval, self.last = interval, last

    def time(self, number: int) -> float:
        """Time of output `number`, s; from the end on, the end."""
        planned = number * self.interval
        return self.last if planned > self.last * (1 - 1e-9) else planned

    def passed(self, simulated: float) -> int:
        """How many of these times but zero have come by the time `simulated`, s."""
        return int(simulated / self.interval + 1e-9)

    def after(self, simulated: float) -> float:
        """The first of these times that is later than `simulated`, s; inf if there is none."""
        passed = simulated * (1 + self.SAME)
        number = max(0, int(simulated / self.interval) - 1)
        while self.time(number) <= passed:
            if self.time(number) == self.last:
                return math.inf
            number += 1
        return self.time(number)

    def is_due(self, simulated: float, planned: float) -> bool:
        """Whether `planned` has come at the time `simulated`, both in s."""
        return simulated * (1 + self.SAME) >= planned


def steps_between(start: float, end: float, dt: float, intervals: Iterable[float]) -> float:
    """How many steps of `dt`, s, lead from `start` to `end`, s.

    Each multiple of one of the `intervals`, s, ends a step, which is shorter for it.
    """
    times = [np.array([start, end])]
    for interval in set(intervals):
        multiples = interval * np.arange(np.floor(start / interval), end / interval + 1)
        times.append(multiples[(multiples > start) & (multiples < end)])
    gaps = np.diff(np.unique(np.concatenate(times)))
    gaps = gaps[gaps > OutputTimes.SAME * end]  # else two of these times are one
    return float(np.maximum(np.ceil(gaps / dt * (1 - 1e-9)), 1.0).sum())


class CheckpointClock:
    """Checkpoints every so many simulated seconds, and every so many minutes of wall time.

    The first by wall time comes after a minute: what goes wrong with a run often does so early.
    """

    FIRST = 60.0  # s of wall time

    def __init__(
        self, every: float | None, minutes: float, next_time: float = 0.0, simulated: float = 0.0
    ) -> None:
        """`every`: s of simulated time, or None; `next_time`: when a resumed run, which stands at
        `simulated`, was to write one, s.
        """
        self.every = every
        self.seconds = 60.0 * minutes
        self._wait = min(self.FIRST, self.seconds)
        self.next_time = math.inf
        if every is not None:
            self.next_time = max(next_time, every) if math.isfinite(next_time) else every
            if simulated > 0.0:  # with another interval the old date may be far off
                self.next_time = min(self.next_time, self._after(simulated))
        self._written = time.monotonic()

    def is_due(self, simulated: float) -> bool:
        """Whether a checkpoint is to be written at this simulated time."""
        return simulated >= self.next_time or time.monotonic() - self._written >= self._wait

    def reset(self, simulated: float) -> None:
        """A checkpoint is about to be written."""
        self._written, self._wait = time.monotonic(), self.seconds
        if self.every is not None:
            self.next_time = self._after(simulated)

    def _after(self, simulated: float) -> float:
        """The first date after a time, s."""
        assert self.every is not None
        return (math.floor(simulated / self.every + 1e-9) + 1) * self.every


class StopRequests:
    """SIGINT, SIGTERM, SIGHUP, or a file STOP in the output folder."""

    def __init__(self, directory: Path) -> None:
        self._file = directory / STOP_FILE
        self.signals: list[int] = []
        """The signals that came."""

    def __bool__(self) -> bool:
        return bool(self.signals) or self._file.exists()

    @property
    def reason(self) -> str:
        """What asked for it: a signal by its name, or the file STOP; "" where nothing did."""
        if self.signals:
            return signal.Signals(self.signals[0]).name
        return f"the file {STOP_FILE}" if self._file.exists() else ""

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Collect signals, so that a run can end at a whole step with its record closed."""
        self._file.unlink(missing_ok=True)
        old = {}
        # Other threads may not handle signals: whoever started them does.
        if threading.current_thread() is threading.main_thread():
            terminals = [stream for stream in (0, 1, 2) if os.isatty(stream)]
            old = {number: signal.signal(number, self._collect) for number in answered()}
            if signal.SIGHUP in old:
                signal.signal(signal.SIGHUP, lambda *said: self._hang_up(terminals, *said))
        try:
            yield
        finally:
            for number, handler in old.items():
                signal.signal(number, handler)
            self._file.unlink(missing_ok=True)

    def _collect(self, number: int, _frame: FrameType | None) -> None:
        self.signals.append(number)

    def _hang_up(self, terminals: list[int], number: int, frame: FrameType | None) -> None:
        """The terminal may be gone, where writing to it would fail: nobody reads that any more."""
        for stream in terminals:
            if not os.isatty(stream):
                nowhere = os.open(os.devnull, os.O_RDWR)
                os.dup2(nowhere, stream)
                os.close(nowhere)
        self._collect(number, frame)


def answered() -> list[signal.Signals]:
    """Signals that end a run; SIGHUP only where it is not ignored, as nohup has it."""
    hangs_up = signal.getsignal(signal.SIGHUP) != signal.SIG_IGN
    return [signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hangs_up else [])]
