"""What `doseki bench --ranks` starts on each rank: one case, timed; rank 0 prints it as JSON."""

from __future__ import annotations

import json
import sys
import time

import numpy as np
from mpi4py import MPI

from ..compiled import available_instruction_sets
from ..parallel.simulation import RankedSimulation
from ..record.history import SHARES
from ..solver.protocol import Simulation
from .case import Case, empty_simulation, fill

ROUNDS = 5
ROUND_SECONDS = 1.0  # at least
MESSAGE_REPEATS, LARGE_MESSAGE = 2000, 1 << 20  # bytes


def started(case: Case, comm: MPI.Intracomm) -> RankedSimulation:
    """The case on the ranks of `comm`, past its first lists and the cut that knows their costs."""
    core = empty_simulation(case)
    if comm.rank == 0:
        fill(core, case)
    simulation = RankedSimulation(core, comm, case.dim)
    simulation.start()
    live(simulation, 3)
    return simulation


def live(simulation: Simulation, lives: int) -> int:
    """Step through whole lives of the lists; gives the number of steps."""
    first, built = simulation.steps, simulation.rebuilds
    while simulation.rebuilds < built + lives:
        simulation.advance(limit=1e30, pause=1e30, max_steps=1)
    return simulation.steps - first


def seconds_per_step(simulation: RankedSimulation, comm: MPI.Intracomm) -> list[float]:
    """Of each round, whole lives of the lists; `comm` has all ranks that are at work."""
    rounds = []
    for _ in range(ROUNDS):
        comm.Barrier()
        began, steps = time.perf_counter(), 0
        while True:
            steps += live(simulation, 1)
            spent = comm.bcast(time.perf_counter() - began)
            if spent > ROUND_SECONDS:
                break
        rounds.append(comm.allreduce((time.perf_counter() - began) / steps, MPI.MAX))
    return rounds


def per_step(
    simulation: RankedSimulation, before: dict[str, float], steps: int
) -> dict[str, float]:
    """Shares of the wall time, and what the busiest rank has sent, since `before`."""
    comm, now = simulation.comm, simulation.core.shares()
    spent = {name: now[name] - before[name] for name in before}
    found = {
        f"share_{name}": comm.allreduce(spent[name]) / comm.allreduce(spent["total"])
        for name in SHARES
    }
    for name in ("bytes_sent", "messages_sent"):
        found[name] = comm.allreduce(spent[name], MPI.MAX) / steps
    found["imbalance"] = comm.allreduce(spent["busy"], MPI.MAX) * comm.size
    found["imbalance"] /= comm.allreduce(spent["busy"])
    found["ghosts"] = comm.allreduce(now["ghosts"]) / comm.allreduce(now["particles"])
    return found


def message_costs(comm: MPI.Intracomm) -> dict[str, float]:
    """Seconds of a message, of a byte, and of a sum over all ranks, as the transport does them."""
    if comm.size == 1:
        return {}
    other = comm.rank ^ 1
    number = np.zeros(1)

    def exchange(size: int) -> float:
        if other >= comm.size:
            return 0.0
        out, back = np.zeros(size, np.uint8), np.empty(size, np.uint8)
        began = time.perf_counter()
        for _ in range(MESSAGE_REPEATS if size < 1000 else 50):
            requests = [comm.Irecv([back, MPI.BYTE], other), comm.Isend([out, MPI.BYTE], other)]
            MPI.Request.Waitall(requests)
        return (time.perf_counter() - began) / (MESSAGE_REPEATS if size < 1000 else 50)

    comm.Barrier()
    small, large = exchange(8), exchange(LARGE_MESSAGE)
    comm.Barrier()
    began = time.perf_counter()
    for _ in range(MESSAGE_REPEATS):
        comm.Allreduce(MPI.IN_PLACE, number, MPI.MAX)
    reduce = (time.perf_counter() - began) / MESSAGE_REPEATS
    return {
        "message_seconds": small,
        "byte_seconds": (large - small) / LARGE_MESSAGE,
        "reduce_seconds": reduce,
    }


def main(dim: int, scheme: str, n: int, together: bool) -> None:
    """`together`: one case of n particles on all ranks; otherwise each rank has one of its own."""
    world = MPI.COMM_WORLD
    comm = world if together else MPI.COMM_SELF
    case = Case(dim, n, "double", 1, available_instruction_sets()[0], scheme=scheme)
    simulation = started(case, comm)
    before, first, built = simulation.core.shares(), simulation.steps, simulation.rebuilds
    rounds = seconds_per_step(simulation, world)
    row: dict[str, object] = {**per_step(simulation, before, simulation.steps - first)}
    row |= message_costs(comm)
    row["steps_per_list"] = (simulation.steps - first) / (simulation.rebuilds - built)
    row |= {"ranks": comm.size, "n": n, "dim": dim, "scheme": scheme}
    row |= {"seconds_per_step": float(np.median(rounds)), "rounds": rounds}
    if world.rank == 0:
        print(json.dumps(row))


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), sys.argv[4] == "together")
