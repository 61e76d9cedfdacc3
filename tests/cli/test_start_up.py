"""The command line starts without what only its commands need."""

from __future__ import annotations

import subprocess
import sys

import pytest

import doseki

PROGRAM = """
import sys
sys.argv = ["doseki", *sys.argv[1:]]
from doseki.cli.main import main
try:
    main()
finally:
    print(*sorted({name.partition(".")[0] for name in sys.modules}))
"""
# What reads scenarios, computes, writes and draws: together they take a second to import.
HEAVY = {
    "h5py", "matplotlib", "mpi4py", "numpy", "psutil", "pydantic", "scipy", "simpleeval", "trimesh",
}  # fmt: skip


def imported(*arguments: str) -> set[str]:
    """Top-level packages that a command has imported when it ends."""
    command = [sys.executable, "-c", PROGRAM, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("words", [["--help"], ["--version"]], ids=" ".join)
def test_help_imports_nothing_heavy(words):
    assert imported(*words) & HEAVY == set()


def test_help_of_a_command_imports_what_typer_reads_options_with():
    assert imported("run", "--help") & HEAVY <= {"pydantic"}


def test_a_version_needs_no_coloured_text():
    assert "rich" not in imported("--version")
    assert "rich" in imported("--help")  # or this test would see nothing


def test_the_package_alone_imports_nothing_but_python():
    program = "import sys; old = {*sys.modules}; import doseki; print(*({*sys.modules} - old))"
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    packages = {name.partition(".")[0] for name in done.stdout.split()}
    assert packages - sys.stdlib_module_names == {"doseki"}


def test_the_version_is_that_of_the_installed_package():
    from importlib.metadata import version

    assert doseki.__version__ == version("doseki")
    with pytest.raises(AttributeError, match="nothing"):
        _ = doseki.nothing
