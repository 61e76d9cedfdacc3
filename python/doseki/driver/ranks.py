"""The ranks that a run is spread over; here the one rank of a run that is not."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from ..compiled import load_core
from ..record.history import SHARES
from ..record.lock import FolderLock
from ..scenario.model import Scenario
from ..solver.build import empty_simulation, filled_simulation
from ..solver.protocol import Columns, Simulation, SimulationView
from ..solver.restoring import check_state
from ..util.cores import allowed_cores
from ..util.finding import Finding
from ..util.telling import Tell, say_nothing

T = TypeVar("T")


class OneRank:
    """A run that is not spread over ranks; parallel.many_ranks has the other kind."""

    rank, count = 0, 1
    rank_on_machine = 0  # among the ranks of this machine
    _held: Path | None = None

    @property
    def is_root(self) -> bool:
        """Whether this rank writes and prints."""
        return self.rank == 0

    def agree(self, value: T) -> T:
        """The value of rank 0, on all ranks."""
        return value

    def on_root(self, work: Callable[[], T]) -> T:
        """What `work` gives on rank 0, on all ranks; they all raise what it raises there."""
        return work()

    def threads(self, wish: int | None) -> int:
        """Threads of each rank: those asked for, or as many as the core takes and may have."""
        return wish or min(load_core().threads(), allowed_cores())

    @contextmanager
    def holding(self, directory: str | Path) -> Iterator[None]:
        """Keep other processes from writing into the folder of a run; once more is no harm.

        Rank 0 holds the lock; all raise UserError where another process has it.
        """
        folder, before = Path(directory).resolve(), self._held
        if folder == before:
            yield
            return
        lock = FolderLock(folder)
        self.on_root(lock.take)
        self._held = folder
        try:
            yield
        finally:
            self._held = before
            lock.release()

    def recorder(self, directory: str | Path, make: Callable[[], Any]) -> Any:
        """The recorder that `make` makes on rank 0, or one that leaves the writing to it."""
        return make()

    def filled_simulation(
        self, scenario: Scenario, tell: Tell = say_nothing
    ) -> tuple[Simulation, list[str], list[Finding]]:
        """A simulation that is yet to be started, the names of its bodies, and warnings."""
        return filled_simulation(scenario, tell=tell)

    def restored_simulation(
        self, scenario: Scenario, body_names: list[str], state: Columns
    ) -> tuple[Simulation, bool]:
        """A simulation with the state of a checkpoint, and whether it goes on to the same bits."""
        simulation = empty_simulation(scenario, body_names)
        check_state(simulation, state, len(scenario.material_names), len(body_names))
        return simulation, simulation.restore(state)

    def whole_checkpoint(self, simulation: Simulation, state: Columns) -> Columns:
        """What `simulation.checkpoint()` gave, put together on rank 0; nothing on the others."""
        return state

    def show(self, simulation: Simulation, look: Callable[[SimulationView], None]) -> None:
        """Let `look` look at the whole of a simulation on rank 0."""
        look(simulation)

    def balance(self, simulation: Simulation) -> dict[str, float]:
        """How evenly the work is spread, and what that costs (docs/output.md)."""
        return {"imbalance": 1.0} | {f"share_{name}": 0.0 for name in SHARES}

    def working_in(self, directory: Path, simulation: Simulation) -> None:
        """Say where a report goes should a rank be lost."""

    def done(self) -> None:
        """The command ends in good order, or with an error that all ranks know."""

    def fail(self, text: str, exit_code: int, say: Callable[[str], None]) -> None:
        """End the other ranks' part of a run, which goes no further after an error on this rank."""
