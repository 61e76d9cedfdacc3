"""Random clouds, on all ranks together and on rank 0 alone: rates, a few steps, neighbour counts.

Arguments: the decomposition.  Prints the differences as JSON.
"""

from __future__ import annotations

import json
import os
import sys
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

sys.path.insert(0, str(Path(__file__).parents[2] / "core"))
sys.path.insert(0, str(Path(__file__).parents[2] / "core" / "oracle"))
from clouds import MATERIALS, random_cloud
from simulations import core_table

from doseki.compiled import load_core
from doseki.parallel.simulation import RankedSimulation

COMM = MPI.COMM_WORLD
RATES = ("acceleration", "density_rate", "deviatoric_stress_rate", "balsara")
FIELDS = ("position", "velocity", "density", "stress")


def simulation(cloud: Any, precision: str, periodic: bool, ranked: bool, h_mode: str) -> Any:
    """A started simulation of a cloud in the unit box."""
    dim = cloud.position.shape[1]
    options = {
        "eta": 1.2, "alpha": 1.0, "cflnumber": 0.1, "cfl_force": 0.1, "skin": 0.05,
        "balsara": True, "sym_grad": False, "tension": "free", "h_mode": h_mode,
        "gravity": [0.0] * dim, "periodic": [periodic] * dim,
        "domain_min": [0.0] * dim, "domain_max": [float(periodic)] * dim,
    }  # fmt: skip
    materials = [core_table(str(k), **vars(material)) for k, material in enumerate(MATERIALS)]
    core = load_core().Simulation("ueta2022", dim, precision, materials, options)
    if COMM.rank == 0:
        core.add_particles(
            **{name: np.ascontiguousarray(values) for name, values in vars(cloud).items()}
        )
    whole = RankedSimulation(core, COMM, dim) if ranked else core
    whole.start()
    return whole


def difference(one: Any, other: Any, names: tuple[str, ...]) -> float:
    """The largest, each field over its largest value."""
    return max(
        float(np.abs(one[name] - other[name]).max() / np.abs(other[name]).max()) for name in names
    )


def compare(dim: int, precision: str, periodic: bool, h_ratio: float, h_mode: str) -> Any:
    """One cloud in both ways."""
    cloud = random_cloud(dim, h_ratio=h_ratio, fixed=0.3, n=600 if dim == 2 else 2000)
    shared = simulation(cloud, precision, periodic, True, h_mode)
    alone = simulation(cloud, precision, periodic, False, h_mode) if COMM.rank == 0 else None
    counts, rates = shared.neighbour_counts(), shared.rates()
    shared.advance(limit=1e9, pause=1e9, max_steps=10)
    later, state = shared.neighbour_counts(), shared.state()
    held = COMM.gather((len(shared.core), shared.core.shares()["ghosts"]))
    if alone is None:
        return None
    before = alone.neighbour_counts()
    start = difference(rates, alone.rates(), RATES)
    alone.advance(limit=1e9, pause=1e9, max_steps=10)
    after = alone.neighbour_counts()
    return {
        "case": [dim, precision, periodic, h_ratio, h_mode],
        "counts": all(
            np.array_equal(mine[name], yours[name])
            for mine, yours in ((counts, before), (later, after))
            for name in ("id", "count")
        ),
        "mean_count": float(before["count"].mean()),
        "rates": start,
        "fields": difference(state, alone.state(), FIELDS),
        "held": [count for count, _ in held],
        "ghosts": [ghosts for _, ghosts in held],
        "rebuilds": [shared.rebuilds, alone.rebuilds],
    }


if __name__ == "__main__":
    os.environ["DOSEKI_DECOMPOSITION"] = sys.argv[1]
    load_core().set_threads(1)
    every = product((2, 3), ("double", "mixed"), (False, True), (1.0, 3.0), ("constant",))
    found = [compare(*case) for case in every]
    found += [compare(dim, "double", False, 1.0, "eq10") for dim in (2, 3)]
    if COMM.rank == 0:
        print(json.dumps(found))
