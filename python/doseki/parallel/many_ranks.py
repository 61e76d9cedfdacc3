"""A run that is spread over the ranks of an MPI communicator."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from mpi4py import MPI

from ..driver.ranks import OneRank
from ..scenario.model import Scenario
from ..scene.ground import ground_of
from ..solver.build import empty_simulation, filled_simulation
from ..solver.protocol import Columns, CoreSimulation, Rates, Simulation, SimulationView
from ..solver.restoring import check_state
from ..util.cores import allowed_cores
from ..util.finding import Finding
from ..util.telling import Tell, say_nothing
from .ground import SharedGround
from .rank_failure import RankFailure
from .simulation import RankedSimulation
from .watchdog import Watchdog

T = TypeVar("T")
PATIENCE = 30.0  # s that a rank which fails waits for the others, which may be slow, to fail too


@dataclass
class Told:
    """The outcome of work that rank 0 did for all."""

    value: Any = None
    error: Exception | None = None

    @classmethod
    def of(cls, work: Callable[[], Any]) -> Told:
        """Does the work."""
        try:
            return cls(work())
        except Exception as error:
            return cls(error=error)

    def result(self) -> Any:
        """What came of it, or an error again."""
        if self.error is not None:
            raise self.error
        return self.value


class ManyRanks(OneRank):
    """See OneRank.  All ranks go through a run together, in the same order of calls."""

    def __init__(self, comm: MPI.Intracomm, watchdog: Watchdog | None = None) -> None:
        self._comm = comm
        # One of its own: ranks that fail call it while others are in the middle of something else.
        self._last_words = comm.Dup()
        self.rank, self.count = comm.rank, comm.size
        neighbours = comm.Split_type(MPI.COMM_TYPE_SHARED)
        self.rank_on_machine, self._count_on_machine = neighbours.rank, neighbours.size
        neighbours.Free()
        self._watchdog = watchdog
        self._directory: Path | None = None
        self._simulation: Simulation | None = None
        processes = comm.gather((MPI.Get_processor_name(), os.getpid()))
        if watchdog and processes:
            host = MPI.Get_processor_name()
            watchdog.watch([pid if name == host else 0 for name, pid in processes])

    def agree(self, value: T) -> T:
        """The value of rank 0, on all ranks."""
        return self._comm.bcast(value)

    def on_root(self, work: Callable[[], T]) -> T:
        """What `work` gives on rank 0, on all ranks; they all raise what it raises there."""
        return self._comm.bcast(Told.of(work) if self.is_root else None).result()

    def threads(self, wish: int | None) -> int:
        """Those asked for, or an equal share of the cores of this machine."""
        return wish or max(1, allowed_cores() // self._count_on_machine)

    def recorder(self, directory: str | Path, make: Callable[[], Any]) -> RankedRecorder:
        """See OneRank."""
        return RankedRecorder(self, Path(directory), make)

    def filled_simulation(
        self, scenario: Scenario, tell: Tell = say_nothing
    ) -> tuple[RankedSimulation, list[str], list[Finding]]:
        """A simulation that rank 0 has filled; when it starts, particles go to their owners.

        Bodies that move are on every rank, so that those ranks are filled as well.
        """
        told = Told.of(lambda: filled_simulation(scenario, tell=tell)) if self.is_root else Told()
        said = None
        if told.value:
            core, names, warnings = told.value
            said = names, warnings, core.has_bodies
        names, warnings, everywhere = self._comm.bcast(Told(said, told.error)).result()
        if self.is_root:
            core = told.result().simulation
        elif everywhere:
            core = filled_simulation(scenario).simulation
        else:
            core = empty_simulation(scenario, names)
        return self._joined(core, scenario), names, warnings

    def _joined(self, core: CoreSimulation, scenario: Scenario) -> RankedSimulation:
        """One of several, which holds its part of the terrain; only rank 0 keeps the whole."""
        if scenario.bed is not None:
            bed = scenario.bed if self.is_root else None
            core.share_terrain(SharedGround(self._comm, bed).part)
            if not self.is_root:
                scenario.forget_heights()
                ground_of.cache_clear()
        return RankedSimulation(core, self._comm, scenario.dim)

    def restored_simulation(
        self, scenario: Scenario, body_names: list[str], state: Columns
    ) -> tuple[RankedSimulation, bool]:
        """See OneRank."""
        core = empty_simulation(scenario, body_names)
        check_state(core, state, len(scenario.material_names), len(body_names))
        simulation = self._joined(core, scenario)
        core.restore_shared(state)
        return simulation, False

    def whole_checkpoint(self, simulation: Simulation, state: Columns) -> Columns:
        """See OneRank."""
        return _ranked(simulation).whole_checkpoint(state)

    def show(self, simulation: Simulation, look: Callable[[SimulationView], None]) -> None:
        """See OneRank."""
        seen = Glimpse(simulation)
        if self.is_root:
            look(seen)

    def balance(self, simulation: Simulation) -> dict[str, float]:
        """See OneRank."""
        return _ranked(simulation).balance()

    def working_in(self, directory: Path, simulation: Simulation) -> None:
        """See OneRank."""
        self._directory, self._simulation = directory, simulation
        if self._watchdog:
            self._watchdog.report_in(directory)

    def done(self) -> None:
        """The run ends in good order, or with an error that all ranks know."""
        if self._watchdog:
            self._watchdog.dismiss()

    def fail(self, text: str, exit_code: int, say: Callable[[str], None]) -> NoReturn:
        """End the run with an error: together where all ranks have it, else at once.

        An error of one rank leaves the others waiting for it, so it ends them.  `say` prints.
        """
        if self._all_fail():
            self.done()
            if self.is_root:
                say(text)
            sys.exit(exit_code)
        try:
            say(f"rank {self.rank} failed: {text}")
            self._report(text)
            self.done()
        finally:
            self._comm.Abort(exit_code)
        raise AssertionError("ranks go on after MPI_Abort")

    def _report(self, text: str) -> None:
        if self._directory is not None and self._simulation is not None:
            simulation = self._simulation
            RankFailure(self.rank, text, simulation.time, simulation.steps).write(self._directory)

    def _all_fail(self) -> bool:
        barrier = self._last_words.Ibarrier()
        end = time.monotonic() + PATIENCE
        while not barrier.Test():
            if time.monotonic() > end:
                return False
            time.sleep(0.01)
        return True


def _ranked(simulation: Simulation) -> RankedSimulation:
    """The simulations of a run on many ranks are its own."""
    assert isinstance(simulation, RankedSimulation)
    return simulation


class Glimpse:
    """A simulation as rank 0 sees it at one moment, without the other ranks' help."""

    def __init__(self, simulation: Simulation) -> None:
        self._state, self._rates, self._count = (
            simulation.state(),
            simulation.rates(),
            len(simulation),
        )
        self.bytes_per_particle = simulation.bytes_per_particle

    def __len__(self) -> int:
        return self._count

    def state(self) -> Columns:
        """See RankedSimulation."""
        return self._state

    def rates(self) -> Rates:
        """See RankedSimulation."""
        return self._rates


class RankedRecorder:
    """The recorder of rank 0 as all ranks call it: they all know when it cannot write."""

    def __init__(self, ranks: ManyRanks, directory: Path, make: Callable[[], Any]) -> None:
        self.directory = directory
        self._ranks = ranks
        self._recorder: Any = None
        self._on_root(lambda: setattr(self, "_recorder", make()))

    def _on_root(self, work: Callable[[], Any]) -> None:
        self._ranks.on_root(lambda: work() and None)

    def snapshot(self, state: Columns, **moment: Any) -> None:
        """See Recorder."""
        self._on_root(lambda: self._recorder.snapshot(state, **moment))

    def history(self, row: dict[str, float]) -> None:
        """See Recorder."""
        self._on_root(lambda: self._recorder.history(row))

    def gauge(self, name: str, header: list[str], rows: list[list[float]]) -> None:
        """See Recorder."""
        self._on_root(lambda: self._recorder.gauge(name, header, rows))

    def sync(self) -> None:
        """See Recorder."""
        self._on_root(lambda: self._recorder.sync())

    def close(self, summary: dict[str, Any]) -> None:
        """See Recorder."""
        self._on_root(lambda: self._recorder.close(summary))
