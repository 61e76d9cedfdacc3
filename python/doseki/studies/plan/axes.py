"""What a study varies: a range, or a list of values, of one key of the scenario."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import tomli_w

from ...scenario.values.units import quantity

NO_UNIT = ("", "1")  # of plain numbers
DIGITS = 6  # of a value that lies somewhere in a range: what a run is known by

Value = float | int | str | bool


@dataclass(frozen=True)
class Axis:
    """A key of the scenario, by the name that --set knows, and the values that it may have.

    Attributes:
        name: of the key.
        unit: of the numbers; empty where the study file gives them without one.
        choices: of a list of values; empty for a range.
        low, high: ends of a range, in `unit`.
        log: whether equal shares of the range are equal ratios.
        count: points on a grid; None where the file does not say.
        key_unit: that of the key in the scenario, in which numbers without a unit are; or empty.

    """

    name: str
    unit: str = ""
    choices: tuple[Value, ...] = ()
    low: float = 0.0
    high: float = 1.0
    log: bool = False
    count: int | None = None
    key_unit: str = ""

    def at(self, share: float) -> Value:
        """The value at a share (0 to 1) of the range, or the choice that lies there."""
        if self.choices:
            return self.choices[min(int(share * len(self.choices)), len(self.choices) - 1)]
        low, high = self._scaled(self.low), self._scaled(self.high)
        found = low + min(max(share, 0.0), 1.0) * (high - low)
        # Rounding must not lead out of the range.
        rounded = float(f"{math.exp(found) if self.log else found:.{DIGITS}g}")
        return min(max(rounded, self.low), self.high)

    def grid(self) -> list[Value]:
        """The choices, or `count` points from end to end."""
        if self.choices:
            return list(self.choices)
        return [self.at(float(share)) for share in np.linspace(0, 1, self.count or 1)]

    def ends(self) -> list[Value]:
        """The least and the greatest value, or all choices."""
        return list(self.choices) or [self.low, self.high]

    def setting(self, value: Value) -> str:
        """KEY=VALUE as --set takes it."""
        if self.unit and not isinstance(value, str):
            return f"{self.name}={float(value)!r} {self.unit}"
        return f"{self.name}={written(value)}"

    def number(self, value: Value) -> float:
        """The value as a number to draw: words by their place in the list."""
        if isinstance(value, str):
            found = quantity(value)
            return float(self.choices.index(value)) if found is None else found[0]
        return float(value)

    def cell(self, value: Value) -> Value:
        """The value as a column of a table has it: a number in the unit that `label` says."""
        return self.number(value) if self.own_unit and isinstance(value, str) else value

    def twice(self) -> tuple[Value, Value] | None:
        """The first two choices that are one value, written in two ways."""
        found: dict[float, Value] = {}
        for value in self.choices if self.is_numeric else ():
            if (first := found.setdefault(self.number(value), value)) is not value:
                return first, value
        return None

    @property
    def is_numeric(self) -> bool:
        """Whether its values are numbers, with or without a unit."""
        words = (v for v in self.choices if isinstance(v, str | bool))
        return all(isinstance(w, str) and quantity(w) is not None for w in words)

    @property
    def own_unit(self) -> str:
        """The unit of its values: the one that they name, else that of the key; empty for words."""
        units = {
            found[1].own for v in self.choices if isinstance(v, str) and (found := quantity(v))
        }
        if self.unit or len(units) == 1:
            return self.unit or units.pop()
        return self.key_unit if self.is_numeric and not units else ""

    def text(self, value: Value) -> str:
        """A value with its unit, as people read it."""
        is_bare = self.own_unit in NO_UNIT or isinstance(value, str)
        return f"{value}" if is_bare else f"{value} {self.own_unit}"

    @property
    def label(self) -> str:
        """Name and unit, as a column of a table has it."""
        return self.name if self.own_unit in NO_UNIT else f"{self.name} [{self.own_unit}]"

    def _scaled(self, value: float) -> float:
        return math.log(value) if self.log else value


def written(value: Any) -> str:
    """A value of a TOML file, as --set takes it: on one line, tables in braces."""
    if isinstance(value, dict):
        inner = (f"{json.dumps(name)} = {written(each)}" for name, each in value.items())
        return f"{{ {', '.join(inner)} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    return tomli_w.dumps({"value": value}).partition("=")[2].strip()
