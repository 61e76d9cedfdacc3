"""When a run writes checkpoints, and when it is asked to stop."""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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


class CheckpointClock:
    """Checkpoints every so many simulated seconds, and every so many minutes of wall time."""

    def __init__(self, every: float | None, minutes: float, next_time: float = 0.0) -> None:
        """`every`: s of simulated time, or None; `next_time`: of a resumed run, s."""
        self.every = every
        self.seconds = 60.0 * minutes
        self.next_time = math.inf if every is None else max(next_time, every)
        self._written = time.monotonic()

    def is_due(self, simulated: float) -> bool:
        """Whether a checkpoint is to be written at this simulated time."""
        return simulated >= self.next_time or time.monotonic() - self._written >= self.seconds

    def reset(self, simulated: float) -> None:
        """A checkpoint is about to be written."""
        self._written = time.monotonic()
        if self.every is not None:
            self.next_time = (math.floor(simulated / self.every + 1e-9) + 1) * self.every


class StopRequests:
    """SIGINT, SIGTERM, or a file STOP in the output folder."""

    def __init__(self, directory: Path) -> None:
        self._file = directory / STOP_FILE
        self._signals: list[int] = []

    def __bool__(self) -> bool:
        return bool(self._signals) or self._file.exists()

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Collect signals, so that a run can end at a whole step with its record closed."""
        self._file.unlink(missing_ok=True)
        numbers = (signal.SIGINT, signal.SIGTERM)
        try:
            old = {n: signal.signal(n, lambda k, _frame: self._signals.append(k)) for n in numbers}
        except ValueError:  # not the main thread: whoever started it handles signals
            old = {}
        try:
            yield
        finally:
            for number, handler in old.items():
                signal.signal(number, handler)
            self._file.unlink(missing_ok=True)
