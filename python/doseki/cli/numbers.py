"""Numbers and words on the command line, within bounds that are declared with each option.

They are read here, as typer says what is wrong in words of its own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from enum import StrEnum
from typing import TypeVar

import typer

LARGEST = 1e12
Word = TypeVar("Word", bound=StrEnum)


def number(low: float = -LARGEST, high: float = LARGEST) -> Callable[[object], float]:
    """What reads a number from `low` to `high`, for typer.Option(parser=...)."""

    def parsed(text: object) -> float:
        try:
            value = float(str(text))
        except ValueError:
            raise typer.BadParameter(f"{text!r} is not a number") from None
        # A default may be infinite: no limit.
        if not low <= value <= high and not (isinstance(text, float) and math.isinf(text)):
            raise typer.BadParameter(f"{text} is outside {low:g} to {high:g}")
        return value

    parsed.__name__ = "number"
    return parsed


def whole(low: int, high: int) -> Callable[[object], int]:
    """The same for whole numbers."""

    def parsed(text: object) -> int:
        digits = re.sub(r"^[+-]", "", str(text).strip())
        if not (digits.isascii() and digits.isdigit()):
            raise typer.BadParameter(f"{str(text)[:40]!r} is not a whole number")
        # More digits than Python reads are too many for any option.
        value = int(str(text)) if len(digits) <= 20 else None
        if value is None or not low <= value <= high:
            raise typer.BadParameter(f"{str(text)[:40]} is outside {low} to {high}")
        return value

    parsed.__name__ = "whole number"
    return parsed


def one_of(words: type[Word]) -> Callable[[object], Word]:
    """What reads one of some words; give the option `choices(words)` as its metavar."""

    def parsed(text: object) -> Word:
        try:
            return words(str(text))
        except ValueError:
            said = str(text)[:40]
            raise typer.BadParameter(f"{said!r} is not one of {', '.join(words)}") from None

    parsed.__name__ = "word"
    return parsed


def choices(words: type[StrEnum]) -> str:
    """How the help names the words that an option may have."""
    return "|".join(words)
