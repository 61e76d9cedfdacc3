"""Changes to a scenario's table before it is evaluated: what they reach, and what they replace."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from enum import Enum
from typing import Any

from ...errors import UserError
from ...util.spelling import suggestion
from ..materials import BUILT_IN
from ..tables.sections import (
    ALIASES,
    EXCLUSIVE,
    RIVALS,
    SECTIONS,
    SINGLE_TABLES,
    TOP_LEVEL_KEYS,
)
from ..values.expressions import is_expression
from ..values.toml_source import Change, KeyPath, Where
from ..values.units import quantity
from .resolve import chooses

# Tables in those of bodies, inflows and gauges, which a change may also begin.
INNER_TABLES = ("array", "motion")


class Gone(Enum):
    """The value of a change that takes a key away."""

    GONE = "gone"


def with_changes(table: dict[str, Any], changes: Sequence[Change], where: Where) -> dict[str, Any]:
    """The table with each change made, in order; `where` learns which keys they gave.

    A key is a top-level key, the name of a parameter, or a dotted path such as
    body.left.velocity or material.basalt.rho0.  Raises UserError.
    """
    table = copy.deepcopy(table)
    for change in changes:
        if change.value is Gone.GONE:
            _remove(change, table)
            continue
        keys = _find(change, table)
        _lay(table, keys, copy.deepcopy(change.value), change, where)
    return table


def place_of(key: str, table: dict[str, Any]) -> KeyPath:
    """The path in a table that a user's key means, whether or not it is there."""
    keys = tuple(key.split("."))
    if len(keys) > 1:
        return keys
    name = ALIASES.get(key, key)
    is_parameter = name not in TOP_LEVEL_KEYS and key in _names_in(table, "parameters")
    return ("parameters", key) if is_parameter else (name,)


def _find(change: Change, table: dict[str, Any]) -> KeyPath:
    """The path in the table that the user's key means."""
    if change.may_add and (begun := _table_to_add(change, table)) is not None:
        return begun
    said, key = change.said, change.key
    keys = tuple(key.split("."))
    parameters = _names_in(table, "parameters")
    if len(keys) == 1:
        keys = (ALIASES.get(key, key),)
        if keys[0] in TOP_LEVEL_KEYS - {*SECTIONS, *SINGLE_TABLES}:
            return keys
        keys = ("parameters", key)
    if keys[0] == "parameters":
        if keys[1] in parameters and keys[2:] in ((), ("value",)):
            return keys[:2]
        known = {*TOP_LEVEL_KEYS, *ALIASES, *parameters} - {*SECTIONS, *SINGLE_TABLES}
        raise UserError(f"{said}: not a key of this scenario{suggestion(key, known)}")
    return _find_in_section(said, keys, table)


def _table_to_add(change: Change, table: dict[str, Any]) -> KeyPath | None:
    """Where a whole table goes, or a parameter that is new; None for other changes."""
    keys = tuple(change.key.split("."))
    if keys[0] == "parameters" and len(keys) == 2 and keys[1] not in _names_in(table, keys[0]):
        return keys
    if not isinstance(change.value, dict) or chooses(change.value) is not None:
        return None
    if len(keys) == 1 and keys[0] in {*SECTIONS, *SINGLE_TABLES}:
        return keys
    return keys if len(keys) == 2 and keys[0] in SECTIONS else None


def _find_in_section(said: str, keys: tuple[str, ...], table: dict[str, Any]) -> KeyPath:
    """Check a path section.name.key...; whether the last key exists is the schema's business."""
    sections = {*SECTIONS, *SINGLE_TABLES} - {"parameters"}
    if len(keys) == 2 and keys[0] in SINGLE_TABLES:
        return keys
    if keys[0] not in sections:
        raise UserError(f"{said}: no table {keys[0]}{suggestion(keys[0], sections)}")
    known = _names_in(table, keys[0]) | (set(BUILT_IN) if keys[0] == "material" else set())
    if keys[1] not in known:
        near = suggestion(f"{keys[0]}.{keys[1]}", {f"{keys[0]}.{name}" for name in known})
        raise UserError(f"{said}: no table {keys[0]}.{keys[1]}{near}")
    part = table.get(keys[0], {}).get(keys[1], {})
    inner = part.get(keys[2]) if len(keys) == 4 and isinstance(part, dict) else None
    if len(keys) == 4 and not isinstance(inner, dict) and keys[2] not in INNER_TABLES:
        known = {*INNER_TABLES, *(k for k, v in part.items() if isinstance(v, dict))}
        above = ".".join(keys[:2])
        near = suggestion(f"{above}.{keys[2]}", {f"{above}.{name}" for name in known})
        raise UserError(f"{said}: no table {above}.{keys[2]}{near}")
    if len(keys) not in (3, 4):
        raise UserError(f"{said}: expected {keys[0]}.{keys[1]}.KEY=value")
    return keys


def _names_in(table: dict[str, Any], section: str) -> set[str]:
    inner = table.get(section)
    return set(inner) if isinstance(inner, dict) else set()


def _lay(table: dict[str, Any], keys: KeyPath, value: Any, change: Change, where: Where) -> None:
    """Put a value into the table; a section or a table of it takes over keys one by one."""
    is_table = len(keys) == 1 or (len(keys) == 2 and keys[0] not in SINGLE_TABLES)
    here = _at(table, keys)
    plain = all(isinstance(each, dict) and chooses(each) is None for each in (value, here))
    if is_table and plain and change.may_add:
        for key, inner in value.items():
            _lay(table, (*keys, key), inner, change, where)
        return
    _put(table, keys, value, change.said)
    where.note_change(keys, change)


def _at(table: Any, keys: KeyPath) -> Any:
    """What stands at `keys`; None where nothing does."""
    for key in keys:
        table = table.get(key) if isinstance(table, dict) else None
    return table


def _put(table: dict[str, Any], keys: KeyPath, value: Any, said: str) -> None:
    if (
        keys[0] == "parameters"
        and _at(table, keys[:2]) is not None
        and keys[2:] in ((), ("value",))
    ):
        _put_parameter(table["parameters"], str(keys[1]), value, said)
        return
    for pair in EXCLUSIVE:
        if keys[0] in pair:
            for rival in pair:
                table.pop(rival, None)
    *above, last = map(str, keys)
    for key in above:
        table = table.setdefault(key, {})
        if not isinstance(table, dict):
            raise UserError(f"{said}: {key} is not a table")
    for pair in RIVALS.get(str(keys[0]), ()) if len(keys) == 3 else ():
        if last in pair:
            for rival in pair:
                table.pop(rival, None)
    table[last] = value


def _put_parameter(parameters: dict[str, Any], name: str, value: Any, said: str) -> None:
    old = parameters[name]
    has_table = isinstance(old, dict) and "value" in old
    if isinstance(value, dict) and not has_table and chooses(value) is None:
        parameters[name] = value  # a table in place of a bare value
        return
    expected = _kind(old["value"] if has_table else old)
    if expected not in ("a word", _kind(value)):
        raise UserError(f"{said}: {name} = {value!r} must be {expected}")
    parameters[name] = {**old, "value": value} if has_table else value


def _kind(value: Any) -> str:
    """What a value is, in words; expressions, quantities and choices stand for numbers."""
    if isinstance(value, bool):
        return "true or false"
    is_word = isinstance(value, str) and not is_expression(value) and quantity(value) is None
    return "a word" if is_word else "a number"


def _remove(change: Change, table: dict[str, Any]) -> None:
    """Take a key, or a table, away; raises UserError where it is not there."""
    *above, last = place_of(change.key, table)
    holder = _at(table, tuple(above))
    if not isinstance(holder, dict) or last not in holder:
        near = suggestion(str(last), holder) if isinstance(holder, dict) else ""
        raise UserError(f"{change.said}: the scenario does not give it{near}")
    del holder[str(last)]
