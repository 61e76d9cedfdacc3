"""A scenario as a running simulation, without a record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

import numpy as np

from ..driver.gauges import build_gauges
from ..driver.sensors import Sensor, build_sensors
from ..errors import PhysicsError
from ..record.particles import FREE
from ..scenario.load import load_scenario
from ..solver.build import build_simulation, load_core
from ..solver.totals import Totals

FOREVER = 10**9  # steps
CASES = Path(__file__).resolve().parent / "cases"

State = dict[str, np.ndarray]

_overrides_of_all: ContextVar[tuple[str, ...]] = ContextVar("overrides of all", default=())


@contextmanager
def in_precision(precision: str | None) -> Iterator[None]:
    """All scenarios within run in this precision; None: in that which they name."""
    token = _overrides_of_all.set((f"precision={precision}",) if precision else ())
    try:
        yield
    finally:
        _overrides_of_all.reset(token)


class Running:
    """A scenario with overrides, to be advanced and looked at."""

    def __init__(self, name: str, *overrides: str) -> None:
        """`name` is that of a scenario in a folder of cases/, else of a shipped one."""
        own = next(CASES.glob(f"*/{name}.toml"), None)
        self.scenario = load_scenario(str(own or name), (*_overrides_of_all.get(), *overrides))
        self.simulation, self.body_names = build_simulation(self.scenario)
        gauges = build_gauges(self.scenario, self.body_names)
        self.sensors: dict[str, Sensor] = build_sensors(gauges)
        self._follow()

    @property
    def time(self) -> float:
        """Time, s."""
        return self.simulation.time

    def constant(self, name: str) -> float:
        """A parameter or top-level number of the scenario."""
        return float(self.scenario.constants[name])

    def state(self) -> State:
        """The particles now."""
        return self.simulation.state()

    def grains(self) -> State:
        """All bodies now, those that do not move, too, in the order in which they were added."""
        return {key: np.asarray(values) for key, values in self.simulation.grains().items()}

    def advance(self, time: float, max_steps: int = FOREVER) -> State:
        """The state at `time`, or after `max_steps` steps if that comes first.

        Raises PhysicsError where the run goes wrong.
        """
        try:
            self._step(time, max_steps)
        except load_core().PhysicsFailure as failure:
            raise PhysicsError(str(failure), *self.simulation.failure) from None
        return self.state()

    def _step(self, time: float, max_steps: int) -> None:
        """Steps, each of which the sensors of the scenario see."""
        if not self.sensors:
            self.simulation.advance(limit=time, pause=time, max_steps=max_steps)
            return
        for _ in range(max_steps):
            if self.time >= time:
                return
            self.simulation.advance(limit=time, pause=time, max_steps=1)
            self._follow()

    def _follow(self) -> None:
        for sensor in self.sensors.values():
            sensor.follow(self.simulation)

    def sampled(self, times: Iterable[float]) -> Iterator[State]:
        """The states at `times`, which must rise."""
        for time in times:
            yield self.advance(time)

    def totals(self) -> Totals:
        """Mass, momentum and energies of the free particles."""
        return self.simulation.totals()

    def of_body(self, state: State, body: str) -> State:
        """The particles of one body."""
        return chosen(state, state["body"] == self.body_names.index(body))

    def mean(self, field: str, body: str) -> np.ndarray:
        """Mean of a field over a body now, weighted with mass."""
        state = self.of_body(self.state(), body)
        return np.average(state[field], axis=0, weights=state["mass"])


def chosen(state: State, mask: np.ndarray) -> State:
    """The particles where `mask` is true."""
    return {key: values[mask] for key, values in state.items()}


def moving(state: State) -> State:
    """The particles that are free to move."""
    return chosen(state, state["motion"] == FREE)
