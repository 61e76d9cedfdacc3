"""A core simulation that is spread over ranks, with the methods of one that is not."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np
from mpi4py import MPI

from ..record.history import SHARES
from ..solver.protocol import (
    Columns,
    CoreFailure,
    CoreSimulation,
    ForceTerms,
    Fragments,
    Grains,
    Loads,
    Rates,
)
from ..solver.totals import Totals
from .balance import Balance
from .engines import chosen_engine
from .transport import Transport

# Of a checkpoint: what each rank has its own part of, added up over the ranks, if at all.
SUMMED = (
    "mass_initial", "entered", "left", "account", "av_dissipation", "av_power", "scheme_work",
    "through_ground", "updates", "plane_mass", "plane_volume", "plane_supplied",
)  # fmt: skip
# Of a checkpoint: what only the rank that wrote it can go on with.
LISTS = ("lists_moving", "lists_fixed", "lists_entries", "lists_position", "stress_record")
NUMBER = re.compile(r"^\d+_")  # of one of several of a kind, as of planes
SHORT = 1e-3  # s of work; too short to tell how it is shared


class RankedSimulation:
    """The same methods as a simulation of the core; all ranks call each of them together.

    What reads particles (`state`, `rates`) gives all of them to rank 0 and none to the others;
    `sample`, `totals` and numbers are the same everywhere.
    """

    def __init__(self, core: CoreSimulation, comm: MPI.Intracomm, dim: int) -> None:
        """`core`: a simulation without particles, but on rank 0, where they are shared out."""
        self.core, self.comm = core, comm
        self._seen = dict.fromkeys((*SHARES, "total", "busy"), 0.0)
        self._balance = {"imbalance": 1.0} | {f"share_{name}": 0.0 for name in SHARES}
        core.join(Transport(comm, dim, chosen_engine(comm, dim), Balance(comm)))

    def __len__(self) -> int:
        return self._sum(len(self.core))

    @property
    def time(self) -> float:
        """See Simulation."""
        return self.core.time

    @property
    def timestep(self) -> float:
        """See Simulation."""
        return self.core.timestep

    @property
    def steps(self) -> int:
        """See Simulation."""
        return self.core.steps

    @property
    def rebuilds(self) -> int:
        """See Simulation."""
        return self.core.rebuilds

    @property
    def skin(self) -> float:
        """See Simulation."""
        return self.core.skin

    @property
    def has_bodies(self) -> bool:
        """See Simulation."""
        return self.core.has_bodies

    @property
    def failure(self) -> CoreFailure:
        """See Simulation."""
        return self.core.failure

    def start(self) -> None:
        """See Simulation."""
        self.core.start()

    def advance(self, limit: float, pause: float, max_steps: int) -> None:
        """See Simulation."""
        self.core.advance(limit, pause, max_steps)

    def grains(self) -> Grains:
        """See Simulation; every rank has all bodies."""
        return self.core.grains()

    def fragments(self) -> Fragments:
        """See Simulation; every rank has all bodies."""
        return self.core.fragments()

    def loads(self) -> Loads:
        """See Simulation; every rank has all meters."""
        return self.core.loads()

    def forget_load_peak(self, meter: int) -> None:
        """See Simulation."""
        self.core.forget_load_peak(meter)

    def checkpoint(self) -> Columns:
        """The part of this rank; see whole_checkpoint."""
        return self.core.checkpoint()

    def restore(self, arrays: Mapping[str, np.ndarray]) -> bool:
        """Go on from what checkpoint() gave this rank."""
        return self.core.restore(arrays)

    def time_phases(self, on: bool) -> None:
        """See Simulation; the phases of this rank."""
        self.core.time_phases(on)

    def phase_seconds(self) -> dict[str, float]:
        """See Simulation; the phases of this rank."""
        return self.core.phase_seconds()

    def bare_pair_rate(self, seconds: float) -> float:
        """See Simulation; that of this rank."""
        return self.core.bare_pair_rate(seconds)

    def interacting_pairs(self) -> float:
        """Pairs of all ranks; see Simulation."""
        return self.comm.allreduce(self.core.interacting_pairs())

    @property
    def updates(self) -> int:
        """Particles stepped, summed over the steps."""
        return self._sum(self.core.updates)

    @property
    def bytes_per_particle(self) -> float:
        """Mean over the particles."""
        return self._mean(self.core.bytes_per_particle)

    @property
    def entries_per_particle(self) -> float:
        """Mean over the particles."""
        return self._mean(self.core.entries_per_particle)

    def state(self) -> Columns:
        """Fields of all particles in the order of their ids."""
        return by_id(gathered(self.comm, self.core.state()))

    def rates(self) -> Rates:
        """Rates of all particles in the order of their ids."""
        local = self.core.rates()
        arrays = {key: value for key, value in local.items() if isinstance(value, np.ndarray)}
        arrays["id"] = self.core.state()["id"]
        found = by_id(gathered(self.comm, arrays))
        del found["id"]
        power = self.comm.allreduce(local["av_power"])
        return cast(Rates, found | {"timestep": local["timestep"], "av_power": power})

    def force_terms(self, particle: int) -> ForceTerms:
        """See Simulation; the same on every rank."""
        parts: list[ForceTerms] = self.comm.allgather(self.core.force_terms(particle))
        return next((part for part in parts if part["acceleration"]), parts[0])

    def neighbour_counts(self) -> Columns:
        """Neighbours within support, in the order of ids."""
        return by_id(gathered(self.comm, self.core.neighbour_counts()))

    def sample(self, low: Sequence[float], high: Sequence[float]) -> Columns:
        """What gauges read of the particles in a box, in the order of their ids, on every rank."""
        parts = self.comm.allgather(self.core.sample(low, high))
        return by_id({key: np.concatenate([part[key] for part in parts]) for key in parts[0]})

    def totals(self) -> Totals:
        """Totals over all particles."""
        local = cast(dict[str, Any], self.core.totals())
        shared = local.pop("mass_asked")  # each rank knows the whole of it
        names = list(local)
        flat = np.concatenate([np.atleast_1d(np.asarray(local[name], float)) for name in names])
        self.comm.Allreduce(MPI.IN_PLACE, flat, MPI.SUM)
        found: dict[str, Any] = {"mass_asked": shared}
        for name in names:
            size = np.size(local[name])
            values, flat = flat[:size], flat[size:]
            found[name] = values.tolist() if np.ndim(local[name]) else float(values[0])
        return cast(Totals, found | {"count": [int(n) for n in found["count"]]})

    def balance(self) -> dict[str, float]:
        """Work of the busiest rank over the mean, and the mean share of the wall time that went
        into each of SHARES, since the last call.
        """
        now = self.core.shares()
        spent = np.array([now[name] - self._seen[name] for name in self._seen])
        busiest = self.comm.allreduce(spent[-1], MPI.MAX)
        mean = self.comm.allreduce(spent) / self.comm.size
        total, busy = mean[-2:]
        if busy > SHORT:
            self._seen = {name: now[name] for name in self._seen}
            self._balance = {"imbalance": float(busiest / busy)}
            for name, seconds in zip(SHARES, mean, strict=False):
                self._balance[f"share_{name}"] = float(seconds / total)
        return self._balance

    def whole_checkpoint(self, state: Columns) -> Columns:
        """On rank 0, what `checkpoint` gave on each rank put together: the state that any number
        of ranks can go on from.  Lists are left out.
        """
        particles = {name: state[name] for name in self.core.particle_arrays}
        whole = gathered(self.comm, particles)
        found = state | whole
        for name in state:
            if NUMBER.sub("", name) in SUMMED:
                found[name] = self.comm.allreduce(state[name])
        for name in LISTS:
            if name in found:
                found[name] = found[name][:0]
        found["lanes"] = np.zeros_like(state["lanes"])
        return found if self.comm.rank == 0 else {}

    def _sum(self, number: int) -> int:
        return self.comm.allreduce(number)

    def _mean(self, of_particle: float) -> float:
        count = len(self.core)
        total, everyone = self.comm.allreduce(np.array([of_particle * count, count]))
        return float(total / max(everyone, 1.0))


def by_id(arrays: Columns) -> Columns:
    """The same rows in the order of `id`."""
    order = np.argsort(arrays["id"], kind="stable")
    return {key: values[order] for key, values in arrays.items()}


def gathered(comm: MPI.Intracomm, arrays: Mapping[str, np.ndarray]) -> Columns:
    """On rank 0 the rows of all ranks, in the order of ranks; none on the others."""
    return {key: _gather_rows(comm, values) for key, values in arrays.items()}


def _gather_rows(comm: MPI.Intracomm, values: np.ndarray) -> np.ndarray:
    values = np.ascontiguousarray(values)
    row = values.itemsize * int(np.prod(values.shape[1:]))
    counts = comm.gather(len(values))
    whole = np.empty((sum(counts) if counts else 0, *values.shape[1:]), values.dtype)
    sizes = [row * count for count in counts] if counts else None
    comm.Gatherv([values, values.nbytes, MPI.BYTE], [whole, sizes, MPI.BYTE] if counts else None)
    return whole
