"""The list of decision records."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from .markup import table


def decision_pages(root: Path) -> Iterator[tuple[str, str]]:
    """The page that lists them; none where there are none."""
    records = sorted((root / "docs" / "decisions").glob("[0-9]*.md"))
    rows = [(f"[{_number(r)}]({r.name})", _title(r)) for r in records]
    tree = "\n".join(["```{toctree}", ":hidden:", "", *(r.stem for r in records), "```"])
    if records:
        yield (
            "decisions/index.md",
            f"{INTRODUCTION}\n{table(('Record', 'Decision'), rows)}\n{tree}\n",
        )


def _number(record: Path) -> str:
    return record.stem.partition("-")[0]


def _title(record: Path) -> str:
    heading = record.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
    return heading.partition(". ")[2] or heading


INTRODUCTION = """\
# Decisions

Each record tells one choice that could have gone another way: what the problem was, which alternatives there were, and the
measurement that decided.
"""
