"""A good state in memory, and the way from it to the last step before a failure."""

from __future__ import annotations

import time
from collections.abc import Callable

from ..compiled import load_core
from ..solver.protocol import Simulation
from .checkpoint import Checkpoint

SHARE = 0.01  # of the wall time that may go into copies
SECONDS = 1.0  # at least, between two copies


class Rewind:
    """Copies the state now and then.  Runs are deterministic, so going on from a copy leads back to
    every later step, the one before a failure included; nothing need be kept at each step.
    """

    def __init__(self) -> None:
        self.last: Checkpoint | None = None
        self._next = 0.0

    def is_due(self) -> bool:
        """Whether the last copy is old."""
        return time.monotonic() >= self._next

    def keep(self, take: Callable[[], Checkpoint]) -> None:
        """Take a copy of the state."""
        started = time.monotonic()
        self.last = take()
        now = time.monotonic()
        self._next = now + max(SECONDS, (now - started) / SHARE)

    def back_to(
        self, simulation: Simulation, step: int, limit_at: Callable[[float], float]
    ) -> Checkpoint | None:
        """Take `simulation` to the state after `step` steps, from the last copy; returns the copy.

        None, and nothing is done, if no copy was ever made. `limit_at(time)` is the time of the
        first output after `time`, s, which steps must meet.  Where steps fail on the way, it is
        left at the copy.
        """
        if self.last is None:
            return None
        simulation.restore(self.last.state)
        try:
            while simulation.steps < step:
                limit = limit_at(simulation.time)
                simulation.advance(limit=limit, pause=limit, max_steps=step - simulation.steps)
        except load_core().PhysicsFailure:
            simulation.restore(self.last.state)
        return self.last
