"""What only a back end may know stays in it: threads, and what binds the core to Python."""

from __future__ import annotations

import re
from pathlib import Path

CORE = Path(__file__).parents[2] / "core"
SOURCES = sorted(file for file in CORE.rglob("*") if file.suffix in {".hpp", ".cpp", ".cu"})


def lines_with(pattern: str, files: list[Path]) -> list[str]:
    """The lines of `files` that match, each with its file and number."""
    return [
        f"{file.relative_to(CORE)}:{number}: {line.strip()}"
        for file in files
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1)
        if re.search(pattern, line)
    ]


def test_openmp_is_in_one_file():
    elsewhere = [file for file in SOURCES if file != CORE / "base" / "parallel.hpp"]
    assert lines_with(r"#pragma omp|<omp\.h>|\bomp_", elsewhere) == []


def test_nanobind_is_where_python_is():
    elsewhere = [file for file in SOURCES if file.parent.name != "python"]
    assert lines_with(r"nanobind", elsewhere) == []


def test_how_fields_are_stored_only_they_know():
    """Others see elements, and bytes where they do the same with all fields."""
    field = (CORE / "base" / "field.hpp").read_text(encoding="utf-8")
    shown = re.sub(r"^(private|protected):.*?^(?=public:|};)", "", field, flags=re.M | re.S)
    assert "class Field " in shown
    assert "std::vector" not in shown
