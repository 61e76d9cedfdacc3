"""Columns of a CSV file, as text."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from ...errors import UserError
from ...util.foreign import open_regular
from ..values.units import Unit

ROWS_AT_ONCE = 100_000
MAX_COLUMNS = 64
MAX_FIELD = 200  # characters; a wrong file (a binary, an essay) fails here, not in memory

SEPARATORS = {";": "semicolons", "\t": "tabs"}  # of spreadsheets


def read_csv_columns(path: Path, example: str = "x,y,vx,vy,...") -> dict[str, np.ndarray]:
    """Column name -> array (N,) of strings; spaces around fields are dropped.

    Blank lines and lines that begin with # are skipped.  Raises UserError, which names `example` as
    a header where there is none.
    """
    with open_regular(path) as (file, size):
        text = io.TextIOWrapper(file if size else io.BytesIO(), "utf-8-sig", newline="")
        try:
            return _read(path, _Lines(text), example)
        except UnicodeDecodeError:
            raise UserError(
                f'{path}: not a text in UTF-8; spreadsheets save that as "CSV UTF-8"'
            ) from None
        except csv.Error as error:
            raise UserError(f"{path}: not a CSV file: {error}") from None


def numbers_in(
    columns: dict[str, np.ndarray], wanted: str, unit: Unit, example: str
) -> list[float]:
    """The column `wanted` in a unit's own word; its header may name another, as in "t [min]".

    Raises ValueError, which names `example` as a header, without it or where it is no column of
    numbers.
    """
    for header, texts in columns.items():
        found = re.fullmatch(rf"{wanted}\s*(?:[\[(]\s*(\S+)\s*[\])])?", header, re.IGNORECASE)
        if not found:
            continue
        factor = unit.factor(found[1]) if found[1] is not None else 1.0
        if factor is None:
            raise ValueError(f'unit of "{header}" is not known; allowed: {", ".join(unit.factors)}')
        return [factor * _number(str(text), wanted, row) for row, text in enumerate(texts, start=1)]
    raise ValueError(f'no column {wanted}; expected a header such as "{example}"')


def check_columns(columns: Iterable[str], known: Mapping[str, Unit], example: str) -> None:
    """Raise ValueError for the first header that is none of the `known` columns."""
    for header in columns:
        name = re.split(r"[\[(]", header)[0].strip()
        if not name:
            raise ValueError(
                "a column has no name: its header ends in a comma, or has two in a row"
            )
        if name.lower() not in [each.lower() for each in known]:
            raise ValueError(
                f'"{header}" is not one of its columns: take it out; expected a header such as '
                f'"{example}"'
            )


def _number(text: str, name: str, row: int) -> float:
    if _is_number(text):
        return float(text)
    raise ValueError(f"row {row}: {name} = {text!r} is not a number")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text  # which Python reads within a number


class _Lines:
    """Lines of a file that hold data, each of bounded length; `number` is that of the last one."""

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self.number = 0

    def __iter__(self) -> Iterator[str]:
        while line := self._file.readline(MAX_COLUMNS * MAX_FIELD):
            self.number += 1
            if line.strip() and not line.lstrip().startswith("#"):
                yield line


def _read(path: Path, lines: _Lines, example: str) -> dict[str, np.ndarray]:
    reader = csv.reader(lines, skipinitialspace=True)
    names = [name.strip() for name in next(reader, [])]
    _check_header(path, names, example)
    chunks: list[list[np.ndarray]] = [[] for _ in names]
    while rows := list(islice(_checked_rows(path, reader, lines, len(names)), ROWS_AT_ONCE)):
        for chunk, column in zip(chunks, zip(*rows, strict=True), strict=True):
            chunk.append(np.char.strip(np.array(column, dtype=str)))
    return {
        name: np.concatenate(chunk) if chunk else np.zeros(0, dtype=str)
        for name, chunk in zip(names, chunks, strict=True)
    }


def _check_header(path: Path, names: list[str], example: str) -> None:
    if not names:
        raise UserError(f'{path}: the file is empty; expected a CSV header such as "{example}"')
    if all(map(_is_number, names)):
        raise UserError(
            f'{path}: begins with numbers; a header such as "{example}" must stand above them'
        )
    for mark, word in SEPARATORS.items():
        if len(names) == 1 and mark in names[0]:
            raise UserError(
                f"{path}: its columns are separated by {word}; expected commas, and points in "
                "decimal numbers"
            )
    if len(names) > MAX_COLUMNS:
        raise UserError(f"{path}: {len(names)} columns; at most {MAX_COLUMNS} are allowed")
    if any("\0" in name for name in names):
        raise UserError(f"{path}: a NUL byte in the header, which no text has")
    repeated = [name for name in names if names.count(name) > 1]
    if repeated:
        raise UserError(f'{path}: the column "{repeated[0]}" appears twice')


def _checked_rows(
    path: Path, reader: Iterator[list[str]], lines: _Lines, width: int
) -> Iterator[list[str]]:
    for row in reader:
        if len(row) != width:
            fields = "1 field" if len(row) == 1 else f"{len(row)} fields"
            raise UserError(
                f"{path}, line {lines.number}: {fields}; the header has {width} columns"
            )
        if any("\0" in field for field in row):
            raise UserError(f"{path}, line {lines.number}: a NUL byte, which no text has")
        if max(map(len, row)) > MAX_FIELD:
            raise UserError(f"{path}, line {lines.number}: a field is too long")
        yield row
