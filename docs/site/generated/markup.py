"""Markdown of generated pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(header: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table; `kind` is a class of style.css."""
    lines = [f"| {' | '.join(header)} |", f"|{'---|' * len(header)}"]
    lines += [f"| {' | '.join(cell(c) for c in row)} |" for row in rows]
    text = "\n".join(lines)
    return f"```{{rst-class}} {kind}\n```\n\n{text}\n" if kind else f"{text}\n"


def cell(text: str) -> str:
    """What may stand in a cell: one line, no bar that ends it."""
    return " ".join(text.split()).replace("|", "\\|")


def code(text: str) -> str:
    """Text as code."""
    return f"`{text}`"


def prose(text: str) -> str:
    """Words of the code as they are: no sign of them means anything to Markdown but `code`."""
    parts = text.split("`")
    for index in range(0, len(parts), 2):
        for sign in "\\*_<>$[]{}#":
            parts[index] = parts[index].replace(sign, "\\" + sign)
    return "`".join(parts)


def sentence(text: str) -> str:
    """Begins with a capital, unless with code, and ends with a full stop."""
    text = " ".join(text.split())
    if not text:
        return text
    first = text.split()[0]
    if first.isalpha() and first.islower() and len(first) > 1:
        text = text[0].upper() + text[1:]
    return text if text.endswith((".", "...")) else f"{text}."
