"""What pydantic objects to, said in one sentence about one key."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from datetime import date, time
from typing import Any

from pydantic import ValidationError

from ...errors import UserError
from ...util.spelling import suggestion
from ..table import Kinds, Table
from ..tables.sections import SECTIONS, table_at
from ..values.toml_source import KeyPath, Where, dotted

EXPECTED = {
    "float_type": 'a number, or an expression such as "= 2*dp"',
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "a string",
    "list_type": "a list in square brackets",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
}
LARGEST_SHOWN = 10**50  # of whole numbers, digit by digit
# Of commands that run a scenario, which some write into it.
OPTIONS = ("threads", "ranks", "device", "output", "overwrite")
LENGTHS = {
    "too_short": ("min_length", "entries", "at least {} needed"),
    "too_long": ("max_length", "entries", "at most {} allowed"),
    "string_too_short": ("min_length", "characters", "at least {} needed"),
    "string_too_long": ("max_length", "characters", "at most {} allowed"),
}
TAGS = ("union_tag_not_found", "union_tag_invalid")
RANGES = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}


# The kind of table that stands at some keys of a file; None where it is none.
KindAt = Callable[[KeyPath, dict[str, Any]], type[Table] | None]


def to_user_error(
    error: ValidationError,
    table: dict[str, Any],
    where: Where,
    above: KeyPath = (),
    kind_at: KindAt = table_at,
) -> UserError:
    """The UserError for the first objection; unknown keys come first (they cause others).

    `table` is what was validated and `above` the keys under which it stands in the file, which is
    a scenario unless `kind_at` knows better.
    """
    objections = sorted(error.errors(), key=lambda item: item["type"] != "extra_forbidden")
    first = objections[0]
    keys = above + _keys_in(table, first)
    for key in reversed(above):
        table = {str(key): table}
    return where.error(keys + _tag_key(keys, first), _sentence(keys, first, table, kind_at))


def _keys_in(table: Any, objection: Any) -> KeyPath:
    """The objection's location as keys of the file, without pydantic's names of union members."""
    keys: list[str | int] = []
    for key in objection["loc"]:
        if _holds(table, key):
            table = table[key]
            keys.append(key)
        elif objection["type"] == "missing" and key == objection["loc"][-1]:
            keys.append(key)
    return tuple(keys)


def _holds(table: Any, key: str | int) -> bool:
    if isinstance(table, dict):
        return key in table
    return isinstance(table, list) and isinstance(key, int) and key < len(table)


def _sentence(keys: KeyPath, objection: Any, table: dict[str, Any], kind_at: KindAt) -> str:
    name, kind, value = dotted(keys), _type_of(objection), objection["input"]
    context = objection.get("ctx", {})
    about = _description(keys, table, kind_at)
    if kind == "extra_forbidden":
        return f"{name} is not a known key{_nearest_key(keys, table, kind_at)}"
    if kind == "missing":
        return f"{name} is missing{about}"
    if kind in TAGS:
        return _tag_sentence(name, _kinds_at(keys), context.get("tag"))
    if kind == "literal_error":
        return f"{name} = {_shown(value)} is not allowed; choose {context['expected']}{about}"
    if kind == "value_error":
        return f"{name}: {context['error']}"
    if kind == "finite_number":
        return f"{name} = {_shown(value)} must be finite{about}"
    if EXPECTED.get(kind) == "a table" and isinstance(value, list):
        return f"{name} must be a table{about}; write [{name}], where [[{name}]] makes a list"
    if kind == "float_type" and type(value) is int:
        return f"{name} = {_shown(value)} is out of range; must be below {sys.float_info.max:.1e}"
    if kind in EXPECTED:
        return f"{name} = {_shown(value)} must be {EXPECTED[kind]}{about}"
    if kind in LENGTHS:
        bound, what, words = LENGTHS[kind]
        limit = words.format(f"{context[bound]} {'is' if context[bound] == 1 else 'are'}")
        what = "entry" if (len(value), what) == (1, "entries") else what
        return f"{name} = {_shown(value)} has {len(value)} {what}; {limit}{about}"
    for bound, words in RANGES.items():
        if bound in context:
            limit = f"{words} {context[bound]:g}"
            return f"{name} = {_shown(value)} is out of range; must be {limit}{about}"
    return f"{name} = {_shown(value)} is not allowed{about}"


def _type_of(objection: Any) -> str:
    """The type of an objection; to what is no table where one should be, that it is none."""
    kind = str(objection["type"])
    is_table = isinstance(objection["input"], dict)
    return "dict_type" if kind == "union_tag_not_found" and not is_table else kind


def _kinds_at(keys: KeyPath) -> Kinds:
    kinds = SECTIONS[str(keys[0])]
    assert isinstance(kinds, Kinds)
    return kinds


def _tag_key(keys: KeyPath, objection: Any) -> KeyPath:
    """The key that says of which kind a table is, where the objection is to that."""
    return (_kinds_at(keys).key,) if _type_of(objection) in TAGS else ()


def _tag_sentence(name: str, kinds: Kinds, tag: str | None) -> str:
    """About a table that does not say rightly of which kind it is."""
    if tag is None:
        return f"{name}.{kinds.key} is missing; choose one of {', '.join(kinds.words)}"
    said = tag.removeprefix(kinds.tag(""))
    return f'{name}.{kinds.key} = "{said}" is not a {kinds.key}{suggestion(said, kinds.words)}'


def _description(keys: KeyPath, table: dict[str, Any], kind_at: KindAt) -> str:
    """What the key means, in brackets."""
    for length in range(len(keys), 0, -1):
        kind = kind_at(keys[: length - 1], table)
        if kind is None:
            continue
        for name, field in kind.model_fields.items():
            if keys[length - 1] == (field.alias or name) and field.description:
                return f" ({field.description})"
        return ""
    return ""


def _nearest_key(keys: KeyPath, table: dict[str, Any], kind_at: KindAt) -> str:
    kind = kind_at(keys[:-1], table)
    if kind is None:
        return ""
    known = [field.alias or name for name, field in kind.model_fields.items()]
    if len(keys) == 1 and keys[0] in OPTIONS:
        return f": it is an option of the command, --{keys[0]}"
    return suggestion(str(keys[-1]), known)


def _shown(value: Any) -> str:
    """The value as the file has it, cut short."""
    text = _as_written(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _as_written(value: Any) -> str:
    """The value in the words of TOML; what only Python has in those of Python."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int) and abs(value) > LARGEST_SHOWN:
        digits = math.floor(math.log10(abs(value))) + 1
        return f"{value // 10 ** (digits - 10)}... ({digits} digits)"
    if isinstance(value, list):
        return f"[{', '.join(map(_as_written, value))}]"
    if isinstance(value, dict):
        inside = ", ".join(f"{key} = {_as_written(inner)}" for key, inner in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    return str(value) if isinstance(value, date | time) else repr(value)
