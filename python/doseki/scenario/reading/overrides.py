"""--set key=value: changes to a scenario as they are written on the command line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from typing import Any

from ...errors import UserError
from ..values.toml_source import Change

FRACTION = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?\s*/\s*[\d.]+(e[-+]?\d+)?", re.IGNORECASE)


def changes_of(overrides: Sequence[str | Change]) -> list[Change]:
    """Each "key=value" as a change, which may be one already; raises UserError where it is none."""
    return [each if isinstance(each, Change) else _change(each) for each in overrides]


def _change(text: str) -> Change:
    key, equals, value = (part.strip() for part in text.partition("="))
    if not equals or not key:
        raise UserError(f'--set {text}: expected key=value, such as dp=0.01 or "alpha=0"')
    return Change(key, _parse(value), f"--set {key}")


def _parse(text: str) -> Any:
    """The value as TOML would read it; a fraction is an expression, anything else a word."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, RecursionError, ValueError):
        return f"= {text}" if FRACTION.fullmatch(text) else text
    return parsed["value"] if set(parsed) == {"value"} else text
