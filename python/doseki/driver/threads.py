"""How many threads a run takes while other programs want its cores."""

from __future__ import annotations

from collections.abc import Callable

WINDOW = 0.4  # s of wall time that a rate of steps is a mean over
FIRST_PATIENCE, LAST_PATIENCE = 16, 512  # windows until the other number is tried


class ThreadChoice:
    """All threads, or as many as there are cores to be had, whichever steps faster.

    Threads wait for one another after every loop.  Where another program has the core of one of
    them, all wait for the system to give it back.  Results do not depend on their number.
    """

    def __init__(self, most: int, take: Callable[[int], None]) -> None:
        """`take` sets the number of threads."""
        self.most = self.count = most
        self._take = take
        self._steps = self._wall = self._processor = 0.0
        self._patience = FIRST_PATIENCE
        self._wait = 0  # windows
        self._rate_of_all: float | None = None  # while fewer are tried

    def spent(self, steps: int, wall: float, processor: float) -> None:
        """Tell what some steps took: wall time and processor time of all threads, s."""
        self._steps, self._wall = self._steps + steps, self._wall + wall
        self._processor += processor
        if self._wall < WINDOW:
            return
        rate, cores = self._steps / self._wall, self._processor / self._wall
        self._steps = self._wall = self._processor = 0.0
        self._choose(rate, cores)

    def _choose(self, rate: float, cores: float) -> None:
        """After a window at this rate of steps, for which so many cores were to be had."""
        if self._rate_of_all is not None:
            if rate < self._rate_of_all:
                self._set(self.most)
            self._rate_of_all = None
            self._wait, self._patience = self._patience, min(2 * self._patience, LAST_PATIENCE)
        elif self._wait > 0:
            self._wait -= 1
        elif self.count < self.most:
            self._set(self.most)
        elif 2 * cores < self.most:
            self._rate_of_all = rate
            self._set(max(1, int(cores)))
        else:
            self._patience = FIRST_PATIENCE

    def _set(self, count: int) -> None:
        self.count = count
        self._take(count)
