"""A small scenario file to change, and the error a text leads to."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from doseki.bodies import build_bodies
from doseki.errors import UserError
from doseki.inflows import build_inflows
from doseki.scenario import load_scenario

MINIMAL = """\
dim = 2
dp = 0.1
time_max = 1
time_out = 0.1
"""
BLOCK = """
[body.block]
shape = "box"
material = "water"
min = [0, 0]
max = [1, 0.5]
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., str]:
    """Write a scenario: top-level lines, then tables (a block of water by default)."""

    def write_file(top: str = "", tables: str = BLOCK, name: str = "case.toml") -> str:
        path = tmp_path / name
        path.write_text(f"{MINIMAL}{top}\n{tables}", encoding="utf-8")
        return str(path)

    return write_file


def load_and_build(path: str, overrides: Sequence[str]) -> None:
    """All that is done with a scenario before a run."""
    scenario = load_scenario(path, overrides)
    particles, names = build_bodies(scenario)
    build_inflows(scenario, names, particles)


@pytest.fixture
def error_of() -> Callable[..., str]:
    """The message of the UserError that loading and building a scenario raises."""

    def message(path: str, *overrides: str) -> str:
        with pytest.raises(UserError) as caught:
            load_and_build(path, overrides)
        text = str(caught.value)
        assert "\n" not in text
        return text

    return message
