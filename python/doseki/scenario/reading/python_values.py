"""Values that a Python program gives, as the values that a TOML file can hold."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UserError
from ..values.toml_source import MAX_DEPTH, KeyPath, dotted

MAX_ENTRIES = 1_000_000  # of a list: beyond, a file of particles is the way


def plain_table(table: Mapping[str, Any], said: str) -> dict[str, Any]:
    """A table of words, numbers, lists and tables; raises UserError for anything else in it.

    Numbers and arrays of numpy, tuples and paths become what a file would have; `said` is how
    messages call the table.
    """
    plain = _table(table, (), said)
    assert isinstance(plain, dict)
    return plain


def plain_value(value: Any, key: str, said: str) -> Any:
    """The same of the value of one key."""
    return _plain(value, (key,), said)


def _plain(value: Any, keys: KeyPath, said: str) -> Any:
    if len(keys) > MAX_DEPTH:
        raise _error(keys[:2], said, f"tables or lists nested more than {MAX_DEPTH} deep")
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, str):
        return _text(value, keys, said)
    if isinstance(value, float):
        if math.isnan(value):
            raise _error(keys, said, "nan is no number")
        return float(value)
    if isinstance(value, os.PathLike):
        return os.fsdecode(value)
    if isinstance(value, Mapping):
        return _table(value, keys, said)
    if isinstance(value, list | tuple | np.ndarray):
        return _list(value, keys, said)
    if value is None:
        raise _error(keys, said, "None is no value; leave the key out, or take it out: without()")
    kind = f"{type(value).__module__}.{type(value).__qualname__}".removeprefix("builtins.")
    raise _error(
        keys,
        said,
        f"a value of type {kind} is not allowed; allowed: numbers, words, true or false, paths,"
        " lists and arrays, tables (dict)",
    )


def _text(value: str, keys: KeyPath, said: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        raise _error(keys, said, f"{value[:60]!r} has characters that no file can hold") from None
    return str.__str__(value)  # that of an enumeration would be its name


def _table(table: Mapping[Any, Any], keys: KeyPath, said: str) -> dict[str, Any]:
    found = {}
    for key, value in table.items():
        if not isinstance(key, str):
            raise _error(keys, said, f"the key {key!r} must be a word")
        word = _text(key, keys, said)
        found[word] = _plain(value, (*keys, word), said)
    return found


def _list(
    values: list[Any] | tuple[Any, ...] | np.ndarray, keys: KeyPath, said: str
) -> list[Any] | Any:
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise _error(keys, said, "entries of the array are masked; give all of them")
    if isinstance(values, np.ndarray) and values.ndim == 0:
        return _plain(values.item(), keys, said)
    if len(values) > MAX_ENTRIES:
        raise _error(keys, said, f"{len(values)} entries; allowed: at most {MAX_ENTRIES}")
    return [_plain(value, (*keys, index), said) for index, value in enumerate(values)]


def _error(keys: KeyPath, said: str, why: str) -> UserError:
    place = f"{dotted(keys)}: " if keys else ""
    return UserError(f"{said}: {place}{why}")
