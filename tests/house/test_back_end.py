"""What only a back end may know stays in it: threads, memory, and what binds the core to Python."""

from __future__ import annotations

import re
from pathlib import Path

CORE = Path(__file__).parents[2] / "core"
OUTSIDE = {"interface", "python"}  # what speaks with callers
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


def test_how_values_are_stored_only_two_files_know():
    """The rest sees fields, arrays and spans, wherever their memory is."""
    storage = {CORE / "base" / "field.hpp", CORE / "base" / "array.hpp"}
    inside = [file for file in SOURCES if file.parts[len(CORE.parts)] not in OUTSIDE]
    assert lines_with(r"std::vector|<vector>", [f for f in inside if f not in storage]) == []
    for file in storage:
        text = shown(file.read_text(encoding="utf-8"))
        assert f"class {file.stem.capitalize()} " in text
        assert "std::vector" not in text


def shown(text: str) -> str:
    """What a header lets others use: private parts and what is inherited privately left out."""
    text = re.sub(r"^(private|protected):.*?^(?=public:|};)", "", text, flags=re.M | re.S)
    return re.sub(
        r": private std::vector<T, Memory<T>> \{.*?^public:", "{", text, flags=re.M | re.S
    )
