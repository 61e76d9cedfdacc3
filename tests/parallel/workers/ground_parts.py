"""A slide on a map, of which each rank holds a part, and again with the whole map on each.

Arguments: the scenario and how many steps.  Space is cut at every chance, into parts that do not
depend on clocks.  Prints what ranks asked for and whether both runs have the same bits.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
from mpi4py import MPI

from doseki.parallel.balance import Balance
from doseki.parallel.decomposition import Multisection
from doseki.parallel.ground import SharedGround
from doseki.parallel.many_ranks import ManyRanks
from doseki.parallel.simulation import RankedSimulation
from doseki.scenario.load import load_scenario

COMM = MPI.COMM_WORLD
ASKED: list[list[float]] = []

cut, part, joined = Multisection.cut, SharedGround.part, ManyRanks._joined


def even_cut(self: Multisection, points: np.ndarray, weights: np.ndarray) -> None:
    """All particles count alike."""
    cut(self, points, np.ones(len(weights)))


def noted_part(self: SharedGround, wanted: list[float]) -> np.ndarray:
    """Remembers what this rank asks for."""
    ASKED.append(wanted)
    return part(self, wanted)


def whole(self: ManyRanks, core: Any, scenario: Any) -> RankedSimulation:
    """One of several, each of which has the whole map."""
    return RankedSimulation(core, COMM, scenario.dim)


def run(steps: int) -> tuple[dict[str, np.ndarray], Any]:
    """The state in the end, on rank 0, and the scenario."""
    scenario = load_scenario(sys.argv[1])
    simulation, _, _ = ManyRanks(COMM).filled_simulation(scenario)
    simulation.start()
    simulation.advance(limit=1e9, pause=1e9, max_steps=steps)
    return simulation.state(), scenario


Balance.is_due = lambda self, busy: True
Multisection.cut, SharedGround.part = even_cut, noted_part
parts, scenario = run(int(sys.argv[2]))
light = bool(np.isnan(scenario.bed.heights).all())
ManyRanks._joined = whole
wholes, scenario = run(int(sys.argv[2]))
sizes = [int(np.prod(wanted[len(wanted) // 2 :])) for wanted in ASKED]
told = COMM.gather({"sizes": [n for n in sizes if n], "first": [w[0] for w in ASKED if w[-1]]})
lights = COMM.gather(light)
if told is not None:
    same = all(np.array_equal(parts[key], wholes[key]) for key in wholes)
    row = {"ranks": told, "light": lights, "nodes": scenario.bed.heights.size, "same": same}
    print(json.dumps(row | {"farthest": float(parts["position"][:, 0].max())}))
