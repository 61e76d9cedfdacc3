"""What a key of a scenario accepts, in words: from its annotation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import annotated_types as bounds
from pydantic import AfterValidator, BeforeValidator
from pydantic.fields import FieldInfo

from doseki.scenario.table import Kinds, Only, Table
from doseki.scenario.values.types import LARGEST, SMALLEST, RefersTo
from doseki.scenario.values.units import Measured, MeasuredColumns

PLAIN = {bool: "true or false", int: "whole number", float: "number", str: "text", Any: "any value"}
# What the functions that check a value make of its type.
CHECKED = {
    "_of_dimension": "vector",
    "_numbers_or_expressions": "vector of numbers or expressions",
    "_number_or_expression": "number or expression",
    "_hydrograph": "rows [t, Q], or a CSV file",
    "_surge": "rows [t, thickness, velocity], or a CSV file",
    "_grading": "rows [d, share]",
    "_depth": 'number, or "normal"',
    "_skin": 'number from 0 to 1, or "auto"',
    "_digest": "text: 32 hexadecimal digits",
    "_known_quantities": "list of names of quantities",
    "_one_per_axis": "list of whole numbers, one for each axis",
}
SILENT = {
    "_bound",
    "_not_nan",
    "_not_zero",
    "_one_line",
    "_precision",
    "array",
}  # that change no words


@dataclass
class Meaning:
    """What is found in an annotation."""

    words: str = ""
    units: list[str] = field(default_factory=list)
    limits: list[str] = field(default_factory=list)
    only: Only | None = None
    inner: type[Table] | None = None  # the table that the key holds


def meaning_of(info: FieldInfo) -> Meaning:
    """What a key accepts.

    Raises KeyError for a type or a check that this module has no words for.
    """
    found = Meaning()
    found.words = _words(info.annotation, info.metadata, found)
    return found


def _words(kind: Any, about: Any, found: Meaning) -> str:
    said = [word for piece in about for word in _of_metadata(piece, found)]
    if get_origin(kind) is Annotated:
        kind, *more = get_args(kind)
        inner = _words(kind, more, found)
        return said[-1] if said else inner
    inner = _plain(kind, found)
    if said:
        return said[-1]
    return inner


def _of_metadata(piece: Any, found: Meaning) -> Iterator[str]:
    """Notes units, limits and schemes; yields words for the type."""
    if isinstance(piece, Measured):
        found.units.append(piece.unit.own)
        if piece.plane is not None:
            found.units.append(f"2-D: {piece.plane.own}")
    elif isinstance(piece, MeasuredColumns):
        found.units.append(", ".join("1" if unit is None else unit.own for unit in piece.columns))
    elif isinstance(piece, Only):
        found.only = piece
    elif isinstance(piece, RefersTo):
        yield f"name of a [{piece.section}.NAME]"
    elif isinstance(piece, AfterValidator | BeforeValidator):
        yield from _of_check(piece)
    elif isinstance(piece, FieldInfo):
        for inner in piece.metadata:
            yield from _of_metadata(inner, found)
    else:
        found.limits += _limits(piece)


def _of_check(piece: AfterValidator | BeforeValidator) -> Iterator[str]:
    name = getattr(piece.func, "__name__", "")
    if name == "check":  # _entries(n)
        yield "list of numbers"
    elif name not in SILENT:
        yield CHECKED[name]


def _limits(piece: Any) -> list[str]:
    signs = ((bounds.Gt, "gt", "above"), (bounds.Ge, "ge", "from"), (bounds.Lt, "lt", "below"),
             (bounds.Le, "le", "up to"))  # fmt: skip
    for kind, name, word in signs:
        if isinstance(piece, kind):
            limit = getattr(piece, name)
            if limit == SMALLEST:
                return ["above 0"]
            return [] if abs(limit) >= LARGEST else [f"{word} {limit:g}"]
    return []


def _plain(kind: Any, found: Meaning) -> str:
    if kind in PLAIN:
        return PLAIN[kind]
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Literal:
        return " or ".join(_value(word) for word in inside)
    if origin in (Union, UnionType):
        ways = [_words(way, (), found) for way in inside if way is not NoneType]
        return ", or ".join(dict.fromkeys(ways))
    if origin is list:
        return _list_words(_words(inside[0], (), found))
    if origin is dict:
        return "tables"
    if isinstance(kind, type) and issubclass(kind, Table):
        found.inner = kind
        return "table"
    raise KeyError(f"no words for the type {kind}")


def _list_words(entry: str) -> str:
    if entry.startswith("list of"):
        return f"list of lists{entry.removeprefix('list')}"
    plural = {"number": "numbers", "whole number": "whole numbers", "vector": "vectors",
              "text": "texts", "any value": "values"}  # fmt: skip
    if entry.startswith("name of a "):
        return entry.replace("name of a ", "list of names of ")
    return f"list of {plural.get(entry, entry)}"


def _value(word: Any) -> str:
    return f'`"{word}"`' if isinstance(word, str) else f"`{word}`"


def kinds_in(info: FieldInfo) -> Kinds | None:
    """The kinds of tables that a section has, where it has several."""
    return next((a for entry in get_args(info.annotation) for a in get_args(entry)
                 if isinstance(a, Kinds)), None)  # fmt: skip
