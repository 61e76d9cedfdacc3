"""Recursive coordinate bisection by Zoltan, where the extension was built and fits the MPI."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mpi4py import MPI


def why_not() -> str:
    """Why Zoltan cannot be used here; empty where it can."""
    from mpi4py import MPI

    if find_spec("doseki._zoltan") is None:
        return "it is not built here (Debian: apt-get install libtrilinos-zoltan-dev, then build)"
    used = MPI.Get_library_version().split(",")[0].split("\n")[0].strip()
    # Two MPI libraries in one process would take each other's calls.
    if not used.startswith("Open MPI"):
        return f"it is built on Open MPI, and the MPI of this run is {used}"
    built = import_module("doseki._zoltan").mpi_version
    return "" if used == built else f"it is built on {built}, and the MPI of this run is {used}"


class ZoltanBisection:
    """See decomposition.Decomposition."""

    name = "zoltan"

    def __init__(self, comm: MPI.Intracomm, dim: int) -> None:
        self._rank, self._ranks = comm.rank, comm.size
        self._zoltan = import_module("doseki._zoltan").Bisection(comm.py2f(), dim)

    def cut(self, points: np.ndarray, weights: np.ndarray) -> None:
        """See Decomposition."""
        self._zoltan.cut(np.ascontiguousarray(points, float), np.ascontiguousarray(weights, float))

    def owners(self, points: np.ndarray) -> np.ndarray:
        """See Decomposition."""
        return self._zoltan.owners(np.ascontiguousarray(points, float))

    def region(self) -> np.ndarray:
        """See Decomposition."""
        return self._zoltan.region(self._rank)

    def ranks_touching(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """See Decomposition."""
        return np.sort(self._zoltan.ranks_touching(list(low), list(high), self._ranks))
