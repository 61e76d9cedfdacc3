"""The code is formatted, and passes the checks of ruff and mypy."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from .arrows import CPP_SUFFIXES, sources

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ("python", "tests", "validation", "bench", "packaging", "docs/site", "gallery")
CLANG_FORMAT = str(Path(sysconfig.get_path("scripts")) / "clang-format")
RUFF, MYPY = ([sys.executable, "-m", tool] for tool in ("ruff", "mypy"))


def expect_silence(*command):
    """Fail with what a command prints, unless it succeeds."""
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if ended.returncode:
        pytest.fail(ended.stdout + ended.stderr, pytrace=False)


def test_cpp_is_formatted():
    files = [str(file) for file in sources(ROOT / "core", CPP_SUFFIXES)]
    expect_silence(CLANG_FORMAT, "--dry-run", "--Werror", *files)


def test_python_is_formatted():
    expect_silence(*RUFF, "format", "--diff", *PYTHON)


def test_python_passes_ruff():
    expect_silence(*RUFF, "check", *PYTHON)


def test_python_passes_mypy():
    expect_silence(*MYPY)
