"""A shipped scenario as a running simulation, without a record."""

from __future__ import annotations

from typing import Any

import numpy as np

from doseki.core import build_simulation
from doseki.scenario import load_scenario

FOREVER = 10**9  # steps


class Case:
    """A scenario with overrides, to be advanced and looked at."""

    def __init__(self, name: str, *overrides: str) -> None:
        self.scenario = load_scenario(name, overrides)
        self.simulation, self.body_names = build_simulation(self.scenario)

    @property
    def time(self) -> float:
        """Time, s."""
        return self.simulation.time

    def advance(self, time: float, max_steps: int = FOREVER) -> dict[str, np.ndarray]:
        """The state at `time`, or after `max_steps` steps if that comes first."""
        self.simulation.advance(limit=time, pause=time, max_steps=max_steps)
        return self.simulation.state()

    def totals(self) -> dict[str, Any]:
        """Mass, momentum and energies of the free particles."""
        return self.simulation.totals()

    def mean(self, field: str, body: str) -> np.ndarray:
        """Mean of a field over a body, weighted with mass."""
        state = self.simulation.state()
        mine = state["body"] == self.body_names.index(body)
        return np.average(state[field][mine], axis=0, weights=state["mass"][mine])
