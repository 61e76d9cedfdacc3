"""Numbers on the command line: finite, and within bounds that are declared with each option."""

from __future__ import annotations

import math
from collections.abc import Callable

import typer

LARGEST = 1e12


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
