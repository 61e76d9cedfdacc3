"""What the validation cases share: one thread, a way to report numbers, the reference data."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from doseki.solver.build import load_core

# Measured and published data are not part of the project; they lie beside its folder.
REFERENCE_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
MEASURED = "measured"


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    """The cases are small: several at once are faster than one on several threads."""
    core = load_core()
    threads = core.threads()
    core.set_threads(1)
    yield
    core.set_threads(threads)


@pytest.fixture
def report(record_property: Callable[[str, object], None]) -> Callable[..., None]:
    """report(what, value, expected, unit): shown at the end of the session."""

    def note(what: str, value: float, expected: float | str, unit: str = "") -> None:
        text = expected if isinstance(expected, str) else f"{expected:.5g}"
        record_property(MEASURED, f"{what}: {value:.5g} {unit} (expected {text} {unit})")

    return note


@pytest.fixture
def reference_data() -> Callable[[str], Any]:
    """reference_data(path): a JSON file of the reference data; skips the test without it."""

    def read(path: str) -> Any:
        file = REFERENCE_DATA / path
        if not file.is_file():
            pytest.skip(f"the reference data are not here: no {file}")
        return json.loads(file.read_text(encoding="utf-8"))

    return read


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """The measured numbers, test by test."""
    lines = [
        f"{test.nodeid.partition('::')[2]}: {text}"
        for outcome in ("passed", "failed")
        for test in terminalreporter.stats.get(outcome, [])
        for name, text in getattr(test, "user_properties", [])
        if name == MEASURED
    ]
    if lines:
        terminalreporter.section("measured against expected")
        for line in lines:
            terminalreporter.write_line(line)
