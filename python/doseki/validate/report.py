"""The table of verdicts, as text, Markdown and JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..record.writer import jsonable
from ..util.files import write_whole_text
from .judging import FAIL, SHORT, Result, Row, failed

HEADINGS = (
    "case", "quantity", "resolution", "value", "exact or measured", "error", "band", "verdict",
    "order",
)  # fmt: skip
NOTE = 60  # characters of a note in the table; the rest stands in the JSON


def table_text(results: Sequence[Result]) -> str:
    """The rows of all cases as an aligned Markdown table."""
    lines = [HEADINGS, *(cells(row) for result in results for row in result.rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEADINGS))]
    padded = [_line([f"{c:{w}}" for c, w in zip(line, widths, strict=True)]) for line in lines]
    rule = _line(["-" * width for width in widths])
    return "\n".join([padded[0], rule, *padded[1:]])


def _line(texts: Sequence[str]) -> str:
    return f"| {' | '.join(texts)} |"


def cells(row: Row) -> tuple[str, ...]:
    """The texts of a row, one per heading."""
    value = row.value
    expected = None if value is None else value.expected
    return (
        row.case,
        _quantity_text(row),
        _text(row.resolution, "g"),
        _text(None if value is None else value.number, ".5g"),
        _text(expected, ".5g"),
        _text(value.error * 100, ".3g") + " %" if value is not None and expected else "",
        row.band,
        row.verdict,
        _text(row.order, ".2f"),
    )


def _quantity_text(row: Row) -> str:
    """The quantity and its unit, or what was tried where there is none."""
    quantity = f"{row.quantity} ({row.unit})" if row.unit else row.quantity or "the run"
    if row.verdict == SHORT:
        return quantity
    note = " ".join(row.note.replace("|", "/").split())
    return f"{quantity} [{note[:NOTE]}]" if row.quantity and note else quantity


def _text(number: float | None, form: str) -> str:
    return "" if number is None else format(number, form)


def summary_line(results: Sequence[Result]) -> str:
    """How many cases passed, failed and fell short."""
    verdicts = [result.verdict for result in results]
    counts = {word: verdicts.count(word) for word in dict.fromkeys(verdicts)}
    return f"{len(results)} cases: " + ", ".join(f"{n} {word}" for word, n in counts.items())


def report_table(results: Sequence[Result], how: Mapping[str, str]) -> dict[str, Any]:
    """The report as JSON holds it; `how`: what was asked of all cases, such as the tier."""
    table = {
        **how,
        "passed": not failed(results),
        "cases": [_case_table(result) for result in results],
    }
    return jsonable(table)


def _case_table(result: Result) -> dict[str, Any]:
    case = result.case
    return {
        "name": case.name,
        "title": case.title,
        "across": case.across,
        "verdict": result.verdict,
        "reasons": {criterion.quantity: criterion.reason for criterion in case.criteria},
        "rows": [row.table() for row in result.rows],
    }


def markdown(results: Sequence[Result], how: Mapping[str, str], pictures: dict[str, str]) -> str:
    """The report as a page: the table, then each case with its reasons and its picture."""
    asked = ", ".join(f"{key}: {value}" for key, value in how.items()).capitalize()
    parts = ["# Validation", f"{asked}. {summary_line(results)}.", table_text(results)]
    for result in results:
        case = result.case
        parts.append(f"## {case.name}: {case.title}")
        parts.append(f"Resolution: {case.across}. Verdict: {result.verdict}.")
        parts.append("\n".join(f"* {c.quantity}: {c.reason}" for c in case.criteria))
        parts += ["\n".join(f"* {line}" for line in remarks([result]))] * bool(remarks([result]))
        if case.name in pictures:
            parts.append(f"![{case.name}]({pictures[case.name]})")
    return "\n\n".join(parts) + "\n"


def remarks(results: Sequence[Result]) -> list[str]:
    """One line for each row that fails or falls short."""
    return [
        f"{row.case}: {row.quantity or 'the run'}: {row.verdict}{': ' * bool(row.note)}{row.note}"
        for result in results
        for row in result.rows
        if row.verdict in (FAIL, SHORT)
    ]


def write_report(
    directory: Path, results: Sequence[Result], how: Mapping[str, str], pictures: dict[str, str]
) -> None:
    """validation.json and validation.md."""
    text = json.dumps(report_table(results, how), indent=1) + "\n"
    write_whole_text(directory / "validation.json", text)
    write_whole_text(directory / "validation.md", markdown(results, how, pictures))
