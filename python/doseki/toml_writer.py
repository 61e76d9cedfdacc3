"""Tables of plain values written as TOML (the standard library only reads it)."""

from __future__ import annotations

import json
import math
import re
from typing import Any


def to_toml(table: dict[str, Any]) -> str:
    """TOML text of nested dictionaries, lists, strings, numbers and booleans.

    None and empty tables are left out.
    """
    return "\n".join(_lines(table, "")).strip() + "\n"


def _lines(table: dict[str, Any], name: str) -> list[str]:
    values = {k: v for k, v in table.items() if not isinstance(v, dict) and v is not None}
    tables = {k: v for k, v in table.items() if isinstance(v, dict)}
    lines = [f"\n[{name}]"] if name and values else []
    lines += [f"{_key(key)} = {_value(value)}" for key, value in values.items()]
    for key, inner in tables.items():
        lines += _lines(inner, f"{name}.{_key(key)}" if name else _key(key))
    return lines


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _string(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return _float(value)
    if isinstance(value, str):
        return _string(value)
    return "[" + ", ".join(_value(entry) for entry in value) + "]"


def _float(value: float) -> str:
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return repr(float(value))


def _string(text: str) -> str:
    # JSON's escapes are a subset of TOML's, save for DEL, which TOML wants escaped.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
