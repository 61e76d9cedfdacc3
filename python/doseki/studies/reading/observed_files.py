"""Files of observations: tables of numbers with units, checked before anything is believed."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np

from ...errors import UserError
from ...scenario.particle_files.columns_csv import numbers_in, read_csv_columns
from ...scenario.values.units import TIME, Unit, unit_named
from ...util.foreign import check_regular_file

MAX_BYTES = 50_000_000
MAX_ROWS = 1_000_000
LARGEST = 1e12
EXAMPLE = "time [s],height [mm],error [mm]"

Table = dict[str, np.ndarray]


def read_table(path: Path, columns: dict[str, str], optional: dict[str, str]) -> Table:
    """Columns of a CSV file, by name, in the units given here; a header may name another.

    Lines that begin with # are skipped; columns that are not asked for are not read. Raises
    UserError where one of `columns` is missing, a unit does not fit, a number is not finite or
    absurd, or the file is not a table.
    """
    texts = _texts(path)
    found = {name: _column(path, texts, name, unit) for name, unit in columns.items()}
    for name, unit in optional.items():
        if any(re.match(rf"{re.escape(name)}\s*([\[(]|$)", header) for header in texts):
            found[name] = _column(path, texts, name, unit)
    return found


def read_series(path: Path, value: str, unit: str) -> Table:
    """Rows of "time", s, of the column `value`, in `unit`, and perhaps its "error"; times rise.

    The column is called "value" in what is returned.
    """
    table = read_table(path, {"time": "s", value: unit}, {"error": unit})
    fallen = np.flatnonzero(np.diff(table["time"]) <= 0)
    if len(fallen):
        raise UserError(f"{path}: row {fallen[0] + 2}: times must rise")
    table["value"] = table.pop(value)
    return table


def read_words(path: Path, name: str) -> list[str]:
    """A column of words."""
    texts = _texts(path)
    if name not in texts:
        raise UserError(f'{path}: no column {name}; expected a header such as "result,value,error"')
    return [str(text) for text in texts[name]]


def check_errors(path: Path, table: Table) -> None:
    """Raise UserError where an error is not above zero."""
    wrong = np.flatnonzero(table.get("error", np.ones(1)) <= 0)
    if len(wrong):
        raise UserError(f"{path}: row {wrong[0] + 1}: the error must be greater than 0")


def _texts(path: Path) -> dict[str, np.ndarray]:
    check_regular_file(path)
    if path.stat().st_size > MAX_BYTES:
        raise UserError(f"{path}: an observation may have at most {MAX_BYTES // 10**6} MB")
    texts = read_csv_columns(path, EXAMPLE)
    rows = len(next(iter(texts.values()), ()))
    if not 1 <= rows <= MAX_ROWS:
        raise UserError(f"{path}: {rows or 'no'} rows; an observation has 1 to {MAX_ROWS}")
    return texts


def _column(path: Path, texts: dict[str, np.ndarray], name: str, word: str) -> np.ndarray:
    """A column in the unit `word`, every number of it finite."""
    unit = TIME if word == "s" else unit_named(word)
    # A unit that scenarios do not know is itself alone.
    known = unit or Unit("a number", "", {word: Fraction(1)})
    try:
        numbers = np.array(numbers_in(texts, re.escape(name), known, EXAMPLE))
    except ValueError as error:
        raise UserError(f"{path}: {error}") from None
    numbers /= known.factor(word) or 1.0
    wrong = np.flatnonzero(~(np.abs(numbers) <= LARGEST))
    if len(wrong):
        raise UserError(
            f"{path}: row {wrong[0] + 1}: {name} = {numbers[wrong[0]]:g} is not a number that can"
            " be compared; leave out what was not observed"
        )
    return numbers
