"""What a program sees of a run while it goes on, and when it is let look."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TypeAlias

import numpy as np

from ..record.fields import FIELD_BY_KEY
from ..record.particles import FIXED
from ..solver.protocol import Simulation
from ..solver.rigid_bodies import grain_table
from ..util.spelling import suggestion
from .schedule import OutputTimes

NAMED = ("material", "body")  # fields that are names


class LiveView(Mapping[str, np.ndarray]):
    """A run at one moment, for a callback: a mapping from field name to a read-only array.

    Names, shapes and units are those of a snapshot of the record: `view["velocity"]` is (N, dim)
    in m/s, `view["material"]` the name of each material, (N,).  An array is made when it is asked
    for; it may be kept, the view itself serves only until the callback returns.
    """

    def __init__(
        self,
        simulation: Simulation,
        time_max: float,
        names: Mapping[str, list[str]],
        totals: Callable[[], dict[str, float]],
    ) -> None:
        """`names` are those that the fields `material` and `body` index."""
        self.time: float = simulation.time
        """Simulated time, s."""
        self.step: int = simulation.steps
        """Steps done."""
        self.dt: float = simulation.timestep
        """Time step, s."""
        self.time_max: float = time_max
        """End of the run, s."""
        self._simulation: Simulation | None = simulation
        self._names, self._totals = names, totals
        self._state: dict[str, np.ndarray] | None = None

    @property
    def totals(self) -> dict[str, float]:
        """What a row of the history has: `kinetic_energy`, `mass_inside` ... (docs/output.md)."""
        self._now()
        return self._totals()

    @property
    def grains(self) -> dict[str, np.ndarray]:
        """The bodies that move, as `Snapshot.grains` has them; empty where there are none."""
        table = grain_table(self._now())
        return {key: self._finished(key, values) for key, values in table.items()}

    def __getitem__(self, key: str) -> np.ndarray:
        """The field of this name, of all particles in the order of their ids."""
        if key == "fixed":
            return _read_only(self._fields()["motion"] == FIXED)
        if key not in FIELD_BY_KEY:
            raise KeyError(f"{key!r} is not a field of the particles{suggestion(key, self)}")
        state, absent = self._fields(), FIELD_BY_KEY[key].absent
        if absent is not None and key not in state:
            return _read_only(np.full(len(state["position"]), absent))
        return self._finished(key, state[key])

    def __iter__(self) -> Iterator[str]:
        return iter((*FIELD_BY_KEY, "fixed"))

    def __len__(self) -> int:
        return len(FIELD_BY_KEY) + 1

    def __repr__(self) -> str:
        return f"<doseki.LiveView at {self.time:g} s of {self.time_max:g} s, step {self.step}>"

    def close(self) -> None:
        """The run goes on: what was not read yet cannot be read any more."""
        self._simulation = self._state = None

    def _now(self) -> Simulation:
        if self._simulation is None:
            raise RuntimeError(
                f"the run has gone on since {self.time:g} s: read within the callback"
            )
        return self._simulation

    def _fields(self) -> dict[str, np.ndarray]:
        simulation = self._now()
        if self._state is None:
            self._state = simulation.state()
        return self._state

    def _finished(self, key: str, values: np.ndarray) -> np.ndarray:
        return _read_only(np.array(self._names[key], str)[values] if key in NAMED else values)


def _read_only(values: np.ndarray) -> np.ndarray:
    values = values.view()
    values.flags.writeable = False
    return values


Callback: TypeAlias = "Callable[[LiveView], object]"  # returns False to stop the run


class Watch:
    """Lets a callback look at a run at its start, and every so often after that.

    The run is the same without it: it says only after which step to pause, and no step is cut
    short for it.
    """

    def __init__(
        self, callback: Callback, every: float | None = None, every_steps: int | None = None
    ) -> None:
        """`every`: s of simulated time; the first step at or past a multiple of it is shown."""
        self._callback = callback
        self._every, self._every_steps = every, every_steps
        self.next_time, self._next_step = -math.inf, 0
        self.error: BaseException | None = None
        """What the callback raised."""
        self.stopped = False
        """Whether the callback has ended the run."""

    def steps_left(self, step: int) -> int | None:
        """How many steps there may be until the next look; None: as many as time allows."""
        return None if self._every_steps is None else max(1, self._next_step - step)

    def is_due(self, time: float, step: int) -> bool:
        """Whether the callback is to look now, and has not ended the run."""
        if self.stopped:
            return False
        by_steps = self._every_steps is not None and step >= self._next_step
        return by_steps or time * (1 + OutputTimes.SAME) >= self.next_time

    def look(self, view: LiveView) -> None:
        """Call the callback; what it raises ends the run in good order, and is kept."""
        if self._every is not None:
            self.next_time = (math.floor(view.time / self._every + 1e-9) + 1) * self._every
        else:
            self.next_time = math.inf
        if self._every_steps is not None:
            self._next_step = (view.step // self._every_steps + 1) * self._every_steps
        try:
            answer = self._callback(view)
            self.stopped = isinstance(answer, bool | np.bool_) and not answer
        except BaseException as error:
            self.error, self.stopped = error, True
        finally:
            view.close()
