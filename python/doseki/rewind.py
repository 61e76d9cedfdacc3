"""A good state in memory, and the way from it to the last step before a failure."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

SHARE = 0.01  # of the wall time that may go into copies
SECONDS = 1.0  # at least, between two copies


class Rewind:
    """Copies the state now and then.  Runs are deterministic, so going on from a copy leads back to
    every later step, the one before a failure included; nothing need be kept at each step.
    """

    def __init__(self) -> None:
        self._state: dict[str, np.ndarray] | None = None
        self._next = 0.0

    def look(self, simulation: Any) -> None:
        """Copy the state if the last copy is old enough."""
        started = time.monotonic()
        if started >= self._next:
            self._state = simulation.checkpoint()
            now = time.monotonic()
            self._next = now + max(SECONDS, (now - started) / SHARE)

    def back_to(self, simulation: Any, step: int, limit_at: Callable[[float], float]) -> bool:
        """Take `simulation` to the state after `step` steps; false if no copy was ever made.

        `limit_at(time)` is the time of the first output after `time`, s, which steps must meet.
        """
        if self._state is None:
            return False
        simulation.restore(self._state)
        while simulation.steps < step:
            limit = limit_at(simulation.time)
            simulation.advance(limit=limit, pause=limit, max_steps=step - simulation.steps)
        return True
