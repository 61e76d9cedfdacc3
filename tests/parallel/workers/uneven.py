"""Particles that move beside fixed ones which cost next to nothing; prints who holds the former."""

from __future__ import annotations

import json

import numpy as np
from mpi4py import MPI

from doseki.compiled import load_core
from doseki.parallel import balance
from doseki.parallel.simulation import RankedSimulation
from doseki.scenario.materials import Material
from doseki.solver.build import core_material

COMM = MPI.COMM_WORLD
SIDE, DP = 60, 0.01
SHARED = 0.3  # of the moving particles on the rank that has fewer
MOST_CUTS = 100
ROCK = Material("rock", "solid", 2750.0, 60.0, shear_modulus=0.0, nu=0.0)
OPTIONS = {
    "eta": 1.2, "alpha": 1.0, "cflnumber": 0.1, "cfl_force": 0.1, "skin": 0.05, "balsara": True,
    "sym_grad": False, "tension": "free", "h_mode": "constant", "gravity": [0.0, 0.0],
    "periodic": [False, False], "domain_min": [0.0, 0.0], "domain_max": [0.0, 0.0],
}  # fmt: skip


class Eager(balance.Balance):
    """Cuts whenever lists are built."""

    def is_due(self, busy: float) -> bool:
        """Always."""
        return True


def moving_of_each(simulation: RankedSimulation) -> list[int]:
    """How many particles that move each rank holds."""
    return COMM.allgather(int(np.sum(simulation.core.state()["motion"] == 0)))


def main() -> None:
    """A block at x > 0 flies; the same at x < -1 is fixed."""
    from doseki.parallel import simulation as module

    module.Balance = Eager
    load_core().set_threads(1)
    block = DP * np.stack(np.meshgrid(*[np.arange(SIDE)] * 2), axis=-1).reshape(-1, 2)
    position = np.concatenate([block, block - np.array([2.0, 0.0])])
    n = len(position)
    fixed = position[:, 0] < -1
    core = load_core().Simulation(
        "ueta2022", 2, "double", [core_material(ROCK, 1.0, "birch_murnaghan")], OPTIONS
    )
    if COMM.rank == 0:
        core.add_particles(
            position=position,
            velocity=np.where(fixed[:, None], 0.0, [[5.0, 0.0]]),
            mass=np.full(n, 2750.0 * DP**2),
            density=np.full(n, 2750.0),
            smoothing_length=np.full(n, 1.2 * DP),
            material=np.zeros(n, np.int32),
            body=np.zeros(n, np.int32),
            motion=fixed.astype(np.int32),
            id=np.arange(n),
        )
    simulation = RankedSimulation(core, COMM, 2)
    simulation.start()
    first = moving_of_each(simulation)
    # Costs are measured, so that a cut which other programs have disturbed may be a bad one.
    for cut in range(2, MOST_CUTS):
        while simulation.rebuilds < cut:
            simulation.advance(limit=1e9, pause=1e9, max_steps=1)
        later = moving_of_each(simulation)
        if min(later) > SHARED * sum(later):
            break
    if COMM.rank == 0:
        print(json.dumps({"first": first, "later": later, "moving": int(np.sum(~fixed))}))


if __name__ == "__main__":
    main()
