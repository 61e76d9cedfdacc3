"""Space cut by the engines that are here; prints what came of it, as JSON."""

from __future__ import annotations

import json

import numpy as np
from mpi4py import MPI

from doseki.parallel.decomposition import Multisection
from doseki.parallel.zoltan import ZoltanBisection, why_not

COMM = MPI.COMM_WORLD


def measured(engine, points, weights, probes):
    """Shares of the weight, and how far the answers of an engine fit together."""
    engine.cut(points, weights)
    owners = engine.owners(points)
    share = COMM.allreduce(np.bincount(owners, weights=weights, minlength=COMM.size))
    low, high = engine.region()
    inside = np.all((points >= low) & (points < high), axis=1)
    touched = []
    for probe in probes:
        corners = probe.min(axis=0), probe.max(axis=0)
        within = set(engine.owners(np.random.default_rng(3).uniform(*corners, (2000, len(low)))))
        touched.append(within <= set(engine.ranks_touching(*corners)))
    everyone = COMM.allgather(engine.owners(np.concatenate(probes)).tolist())
    return {
        "engine": engine.name,
        "dim": len(low),
        "imbalance": float(share.max() / share.mean()),
        # A point on a cut may be either side's.
        "strays": COMM.allreduce(int(np.sum(inside != (owners == COMM.rank)))),
        "touched": all(COMM.allgather(all(touched))),
        "same_everywhere": all(part == everyone[0] for part in everyone),
    }


def main():
    """Uneven points with uneven weights, each rank with its own."""
    random = np.random.default_rng(COMM.rank)
    found = []
    for dim in (2, 3):
        points = random.normal(size=(20_000, dim)) * np.array([4.0, 1.0, 1.0])[:dim]
        weights = random.uniform(0.5, 1.5, len(points)) * (1 + 3 * (points[:, 0] > 2))
        probes = np.random.default_rng(1).uniform(-3, 3, (20, 2, dim))
        engines = [Multisection(COMM, dim)]
        if not why_not():
            engines.append(ZoltanBisection(COMM, dim))
        found += [measured(engine, points, weights, list(probes)) for engine in engines]
    if COMM.rank == 0:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
