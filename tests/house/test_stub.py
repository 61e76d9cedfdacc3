"""The compiled module has types, and its simulation is what the solver asks for."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from doseki.compiled import load_core

PROGRAM = """
import core
from doseki.solver.protocol import CoreSimulation

def simulation(made: core.Simulation) -> CoreSimulation:
    return made
"""


@pytest.fixture
def stub() -> str:
    """Text of the stub that the build has made beside the module."""
    module = Path(str(load_core().__file__))
    return (module.parent / f"{module.name.partition('.')[0]}.pyi").read_text()


def check(folder: Path, stub: str) -> subprocess.CompletedProcess[str]:
    """What mypy says of PROGRAM with `stub` as the module core; it remembers what it has read."""
    (folder / "core.pyi").write_text(stub)
    (folder / "program.py").write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--ignore-missing-imports", "program.py"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_the_simulation_of_the_core_is_what_the_protocol_describes(tmp_path, stub):
    done = check(tmp_path, stub)
    assert done.returncode == 0, done.stdout
    lacking = check(tmp_path, stub.replace("def totals(", "def sums("))
    assert lacking.returncode == 1
    assert "totals" in lacking.stdout
