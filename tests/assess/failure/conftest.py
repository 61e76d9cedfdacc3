"""Runs that go wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from doseki.assess.failure.failure import explanation
from doseki.errors import PhysicsError
from doseki.record.reader import Run, load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

HEAD = """\
schema = 1
dim = 2
dp = 0.01
time_max = 0.05
time_out = 0.01
xi = 0.05
"""
BLOCK = """
[body.block]
shape = "box"
material = "basalt"
min = [0, 0]
max = [0.08, 0.08]
"""


@dataclass
class FailedRun:
    """What a failed run left behind."""

    error: PhysicsError
    report: dict[str, Any]  # failure.json
    paragraph: str  # of `doseki explain`
    run: Run


@pytest.fixture
def fail(tmp_path: Path) -> Callable[..., FailedRun]:
    """Runs a scenario text that must fail, and gives what is left of it."""

    def run(text: str, *settings: str) -> FailedRun:
        (tmp_path / "case.toml").write_text(HEAD + text)
        folder = tmp_path / "run"
        with pytest.raises(PhysicsError) as error:
            run_scenario(
                load_scenario(tmp_path / "case.toml", settings), folder, RunOptions(threads=1)
            )
        report = json.loads((folder / "failure.json").read_text())
        loaded = load(folder)
        return FailedRun(error.value, report, explanation(loaded.folder), loaded)

    return run


@pytest.fixture
def block() -> str:
    """A block of 8 x 8 particles of basalt."""
    return BLOCK
