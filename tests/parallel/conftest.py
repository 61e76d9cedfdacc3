"""Work on several MPI ranks, started from a test."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import doseki
from doseki.errors import UserError
from doseki.parallel.launch import mpiexec

WORKERS = Path(__file__).parent / "workers"
SECONDS = 600  # after which ranks hang; they take a few


def _launcher() -> str:
    if find_spec("mpi4py") is None:
        pytest.skip("mpi4py is not installed: pip install doseki[mpi]")
    try:
        return mpiexec()
    except UserError:
        pytest.skip("mpiexec is not installed: pip install doseki[mpi]")


def environment(**more: str) -> dict[str, str]:
    """That of a process which imports the same doseki, on one thread."""
    paths = [str(Path(doseki.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    return os.environ | {
        "PYTHONPATH": os.pathsep.join(filter(None, paths)),
        "OMP_NUM_THREADS": "1",
        **more,
    }


@pytest.fixture(scope="session")
def launcher() -> str:
    """mpiexec, or a skip with the reason."""
    return _launcher()


@pytest.fixture(scope="session")
def work(launcher: str) -> Callable[..., Any]:
    """Runs workers/NAME.py on some ranks; gives what rank 0 printed last, as JSON."""

    def run(name: str, ranks: int, *arguments: str) -> Any:
        script = [sys.executable, "-m", "mpi4py", str(WORKERS / f"{name}.py"), *arguments]
        done = subprocess.run(
            [launcher, "-n", str(ranks), *script],
            env=environment(),
            capture_output=True,
            text=True,
            timeout=SECONDS,
            stdin=subprocess.DEVNULL,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout.splitlines()[-1])

    return run


@pytest.fixture(scope="session")
def open_mpi() -> Callable[..., Any]:
    """As `work`, on Debian's Open MPI, which Zoltan is built on."""
    _launcher()
    found = shutil.which("mpiexec.openmpi")
    if found is None or find_spec("doseki._zoltan") is None:
        pytest.skip(
            "Zoltan is not here: apt-get install libtrilinos-zoltan-dev libopenmpi-dev openmpi-bin"
        )

    def run(name: str, ranks: int, *arguments: str) -> Any:
        script = [sys.executable, "-m", "mpi4py", str(WORKERS / f"{name}.py"), *arguments]
        done = subprocess.run(
            [found, "--oversubscribe", "-n", str(ranks), *script],
            env=environment(
                MPI4PY_MPIABI="openmpi",
                OMPI_ALLOW_RUN_AS_ROOT="1",
                OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
            ),
            capture_output=True,
            text=True,
            timeout=SECONDS,
            stdin=subprocess.DEVNULL,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout.splitlines()[-1])

    return run


@pytest.fixture(scope="session")
def command(launcher: str) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs a command of doseki on some ranks; `script` takes the place of the program."""

    def run(
        ranks: int, *arguments: str, script: str | None = None
    ) -> subprocess.CompletedProcess[str]:
        program = [str(WORKERS / script)] if script else ["-m", "doseki.cli.main"]
        start = [launcher, "-n", str(ranks)] if ranks > 1 else []
        return subprocess.run(
            [*start, sys.executable, *program, *map(str, arguments)],
            env=environment(),
            capture_output=True,
            text=True,
            timeout=SECONDS,
            stdin=subprocess.DEVNULL,
            check=False,
        )

    return run
