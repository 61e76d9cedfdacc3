"""--set key=value: changes to a scenario's table before it is evaluated."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Sequence
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
from ..values.toml_source import KeyPath, Where
from ..values.units import quantity

# Tables in those of bodies, inflows and gauges, which a setting may also begin.
INNER_TABLES = ("array", "motion")
FRACTION = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?\s*/\s*[\d.]+(e[-+]?\d+)?", re.IGNORECASE)


def apply_overrides(
    table: dict[str, Any], overrides: Sequence[str], where: Where
) -> dict[str, Any]:
    """The table with each "key=value" applied; `where` learns which keys they were.

    A key is a top-level key, the name of a parameter, or a dotted path such as
    body.left.velocity or material.basalt.rho0.  Raises UserError.
    """
    table = copy.deepcopy(table)
    for text in overrides:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise UserError(f'--set {text}: expected key=value, such as dp=0.01 or "alpha=0"')
        keys = _find(key.strip(), table)
        _put(table, keys, _parse(value.strip()))
        where.note_override(keys, key.strip())
    return table


def _parse(text: str) -> Any:
    """The value as TOML would read it; a fraction is an expression, anything else a word."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, RecursionError, ValueError):
        return f"= {text}" if FRACTION.fullmatch(text) else text
    return parsed["value"] if set(parsed) == {"value"} else text


def _find(key: str, table: dict[str, Any]) -> KeyPath:
    """The path in the table that the user's key means."""
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
        raise UserError(f"--set {key}: not a key of this scenario{suggestion(key, known)}")
    return _find_in_section(key, keys, table)


def _find_in_section(key: str, keys: tuple[str, ...], table: dict[str, Any]) -> KeyPath:
    """Check a path section.name.key...; whether the last key exists is the schema's business."""
    sections = {*SECTIONS, *SINGLE_TABLES} - {"parameters"}
    if len(keys) == 2 and keys[0] in SINGLE_TABLES:
        return keys
    if keys[0] not in sections:
        raise UserError(f"--set {key}: no table {keys[0]}{suggestion(keys[0], sections)}")
    known = _names_in(table, keys[0]) | (set(BUILT_IN) if keys[0] == "material" else set())
    if keys[1] not in known:
        near = suggestion(f"{keys[0]}.{keys[1]}", {f"{keys[0]}.{name}" for name in known})
        raise UserError(f"--set {key}: no table {keys[0]}.{keys[1]}{near}")
    part = table.get(keys[0], {}).get(keys[1], {})
    inner = part.get(keys[2]) if len(keys) == 4 and isinstance(part, dict) else None
    if len(keys) == 4 and not isinstance(inner, dict) and keys[2] not in INNER_TABLES:
        known = {*INNER_TABLES, *(k for k, v in part.items() if isinstance(v, dict))}
        above = ".".join(keys[:2])
        near = suggestion(f"{above}.{keys[2]}", {f"{above}.{name}" for name in known})
        raise UserError(f"--set {key}: no table {above}.{keys[2]}{near}")
    if len(keys) not in (3, 4):
        raise UserError(f"--set {key}: expected {keys[0]}.{keys[1]}.KEY=value")
    return keys


def _names_in(table: dict[str, Any], section: str) -> set[str]:
    inner = table.get(section)
    return set(inner) if isinstance(inner, dict) else set()


def _put(table: dict[str, Any], keys: KeyPath, value: Any) -> None:
    if keys[0] == "parameters":
        _put_parameter(table["parameters"], str(keys[1]), value)
        return
    for pair in EXCLUSIVE:
        if keys[0] in pair:
            for rival in pair:
                table.pop(rival, None)
    *above, last = map(str, keys)
    for key in above:
        table = table.setdefault(key, {})
        if not isinstance(table, dict):
            raise UserError(f"--set {'.'.join(map(str, keys))}: {key} is not a table")
    for pair in RIVALS.get(str(keys[0]), ()) if len(keys) == 3 else ():
        if last in pair:
            for rival in pair:
                table.pop(rival, None)
    table[last] = value


def _put_parameter(parameters: dict[str, Any], name: str, value: Any) -> None:
    old = parameters[name]
    has_table = isinstance(old, dict) and "value" in old
    expected = _kind(old["value"] if has_table else old)
    if expected not in ("a word", _kind(value)):
        raise UserError(f"--set {name}: {name} = {value!r} must be {expected}")
    parameters[name] = {**old, "value": value} if has_table else value


def _kind(value: Any) -> str:
    """What a value is, in words; expressions, quantities and choices stand for numbers."""
    if isinstance(value, bool):
        return "true or false"
    is_word = isinstance(value, str) and not is_expression(value) and quantity(value) is None
    return "a word" if is_word else "a number"
