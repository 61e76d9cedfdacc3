"""The list of equations by number: under which heading each stands, and which files cite it."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from .markup import table

TAG = re.compile(r"\\tag\{([^}]*)\}")
HEADING = re.compile(r"^#{1,4} (.*)$")
NUMBER = r"\(?\d+[a-d]?\)?"
CITED = re.compile(
    rf"\b[Ee]qs?\.\s*(?:[*/#]*\s*)({NUMBER}(?:(?:,\s*(?:and\s+)?|\s+(?:and|to)\s+|-){NUMBER})*)"
)
RANGE = re.compile(rf"({NUMBER})(?:\s+to\s+|-)({NUMBER})")
TREES = {"python/doseki": ("*.py",), "core": ("*.hpp", "*.cpp")}


def equation_pages(root: Path) -> Iterator[tuple[str, str]]:
    """The page that lists the equations by number."""
    headings = headings_of(root)
    files = citing_files(root, set(headings))
    rows = [
        (f"[({number})](../equations.md#eq-{number})", headings[number],
         ", ".join(f"`{f}`" for f in sorted(files[number])))
        for number in sorted(headings, key=_order)
    ]  # fmt: skip
    text = table(("Equation", "Heading", "Cited in the code"), rows, "equations")
    yield "reference/equation-index.md", f"{INTRODUCTION}\n{text}"


INTRODUCTION = """\
# Equations by number

Code, scenario files and these pages cite [the equations](../equations.md) by number. (1) to (19) keep the numbers of the paper on
which the scheme `ueta2022` stands. The last column names the files in which a comment or a message cites the equation.
"""


def headings_of(root: Path) -> dict[str, str]:
    """The heading under which each number stands."""
    found, above = {}, ""
    for line in (root / "docs" / "equations.md").read_text(encoding="utf-8").splitlines():
        if heading := HEADING.match(line):
            above = heading[1]
        for number in TAG.findall(line):
            found[number] = above
    return found


def citing_files(root: Path, known: set[str]) -> dict[str, set[str]]:
    """The files that cite each of the `known` numbers."""
    files = defaultdict(set)
    for tree, patterns in TREES.items():
        for path in sorted(p for pattern in patterns for p in (root / tree).rglob(pattern)):
            for number in cited_numbers(path.read_text(encoding="utf-8")):
                if number in known:
                    files[number].add(path.relative_to(root).as_posix())
    return files


def cited_numbers(text: str) -> set[str]:
    """The numbers of equations that a text cites; of a range all."""
    found: set[str] = set()
    for match in CITED.finditer(re.sub(r"\n\s*(?:///?|\*|#)?\s*", " ", text)):
        found |= set(re.findall(r"\d+[a-d]?", match[1]))
        for first, last in RANGE.findall(match[1]):
            low, high = (int(re.sub(r"\D", "", end)) for end in (first, last))
            found |= {str(number) for number in range(low, high + 1)}
    return found


def _order(number: str) -> tuple[int, str]:
    digits = re.sub(r"\D", "", number)
    return int(digits), number[len(digits) :]
