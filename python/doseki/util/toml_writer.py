"""Tables of plain values written as TOML (the standard library only reads it)."""

from __future__ import annotations

from typing import Any

import tomli_w


def to_toml(table: dict[str, Any]) -> str:
    """TOML text of nested dictionaries, lists, strings, numbers and booleans.

    None and empty tables, which TOML has not or needs not, are left out.
    """
    return tomli_w.dumps(_without_gaps(table))


def _without_gaps(table: dict[str, Any]) -> dict[str, Any]:
    """The same without None, and without tables that have nothing else."""
    inner = {key: _without_gaps(v) if isinstance(v, dict) else v for key, v in table.items()}
    return {key: value for key, value in inner.items() if value is not None and value != {}}
