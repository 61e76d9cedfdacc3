"""Tables that others put into the folder of a run: loads, sections (CSV or JSON)."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import UserError, one_line
from ...util.foreign import read_text, readable
from ..markup import UNKNOWN, Content, Markup, section, table, tag, terms
from .pictures import Album

MOST_BYTES = 20 * 2**20  # of a file that is read
MOST_ROWS, MOST_COLUMNS = 40, 30  # of a table that are shown
LONGEST = 200  # characters of a cell
DEEPEST = 3  # tables within tables
DIGITS = 5
REASONS = {  # of what has no number, by the stem of a table
    "loads": "no mean over less than the interval of its gauge or over more than the record, and "
    "no peak where nothing acted",
}


def tables_of(folder: Path, stem: str, title: str, album: Album) -> Markup | None:
    """The section of STEM.csv, or STEM.json without it, and of a folder STEM/ with its pictures.

    A file that cannot be read is left out, with a note.
    """
    both = [folder / f"{stem}{ending}" for ending in (".csv", ".json")]
    files = [file for file in both if file.exists()][:1]
    inside = folder / stem
    if inside.is_dir():
        files += sorted(f for f in inside.iterdir() if f.suffix in (".csv", ".json"))
    shown: list[Content] = []
    for file in files:
        try:
            shown.append([tag("h3", file.name), list(_shown(file, REASONS.get(stem, "no number")))])
        except UserError as error:
            album.notes.append(one_line(f"{file.name} is left out: {error}."))
    pictures = album.folder(inside, matter=None if stem == "loads" else ())
    return section(
        title, shown, tag("div", pictures, class_="gallery") if pictures else None, name=stem
    )


def _shown(file: Path, reason: str) -> Iterator[Content]:
    text = read_text(file, MOST_BYTES)
    with readable(file, kind=file.suffix[1:].upper()):
        if file.suffix == ".csv":
            yield from _rows(list(csv.reader(text.splitlines())), reason)
        else:
            yield from _value(json.loads(text), 0, reason)


def _rows(rows: list[list[str]], reason: str) -> Iterator[Content]:
    """A table and, where it is long, a word about the rest: rows are spread over all of it."""
    if not rows:
        return
    head, body = rows[0], rows[1:]
    step = max(1, math.ceil(len(body) / MOST_ROWS))
    shown = [[_cell(cell) for cell in row[:MOST_COLUMNS]] for row in body[::step]]
    yield table([_cell(cell) for cell in head[:MOST_COLUMNS]], shown)
    if any(UNKNOWN in row for row in shown):
        yield tag("p", f"{UNKNOWN}: {reason}.", class_="small")
    if step > 1 or len(head) > MOST_COLUMNS:
        columns = f", {MOST_COLUMNS} of {len(head)} columns" if len(head) > MOST_COLUMNS else ""
        text = f"{len(shown)} of {len(body)} rows are shown{columns}."
        yield tag("p", text, class_="small")


def _value(value: Any, depth: int, reason: str) -> Iterator[Content]:
    """A list of tables as one table, a table as names and values, anything else as text."""
    if isinstance(value, list) and value and all(isinstance(each, dict) for each in value):
        names = list(dict.fromkeys(str(key) for each in value for key in each))
        rows = [[_text(each.get(name, "")) for name in names] for each in value]
        yield from _rows([names, *rows], reason)
    elif isinstance(value, dict) and depth < DEEPEST:
        plain = {
            str(k): _cell(_text(v)) for k, v in value.items() if not isinstance(v, dict | list)
        }
        if plain:
            yield terms(plain)
        for key, inner in value.items():
            if isinstance(inner, dict | list):
                yield tag("h4", _cell(str(key)))
                yield from _value(inner, depth + 1, reason)
    else:
        yield tag("p", _cell(_text(value)))


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _cell(text: str) -> str:
    """A cell that is not too long; a number in a few digits."""
    try:
        number = float(text)
    except ValueError:
        return text if len(text) <= LONGEST else f"{text[:LONGEST]} ..."
    if math.isnan(number):
        return UNKNOWN
    return (
        f"{number:.{DIGITS}g}" if math.isfinite(number) and not text.isdigit() else text[:LONGEST]
    )
