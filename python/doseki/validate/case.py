"""What a validation case is: how it runs, what is read from it, and what that must be."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

TIERS = ("coarse", "full")


@dataclass(frozen=True)
class Value:
    """A number read from a run, and what it should be (None: the number is itself an error)."""

    number: float
    expected: float | None = None

    @property
    def error(self) -> float:
        """Relative to what is expected; absolute where that is nothing or zero."""
        if not self.expected:
            return self.number
        return self.number / self.expected - 1


@dataclass(frozen=True)
class Band:
    """Where the number, or its error, must lie."""

    low: float
    high: float
    of: Literal["number", "error"]

    def holds(self, value: Value) -> bool:
        """Whether a value lies inside; what is not a number never does."""
        number = value.number if self.of == "number" else value.error
        return self.low <= number <= self.high

    def __str__(self) -> str:
        if self.of == "error":
            return f"error within {100 * self.high:.3g} %"
        if self.low == -self.high:
            return f"size at most {self.high:.3g}"
        if math.isinf(self.low):
            return f"at most {self.high:.3g}"
        return f"{self.low:.4g} to {self.high:.4g}"


def within(tolerance: float) -> Band:
    """The error is at most `tolerance` in size."""
    return Band(-tolerance, tolerance, "error")


def between(low: float, high: float) -> Band:
    """The number lies from `low` to `high`."""
    return Band(low, high, "number")


def at_most(limit: float) -> Band:
    """The number is at most `limit`."""
    return between(-math.inf, limit)


def small(limit: float) -> Band:
    """The number, of either sign, is at most `limit` in size."""
    return between(-limit, limit)


@dataclass(frozen=True)
class Criterion:
    """What one quantity must be, and why that much and no more is asked."""

    quantity: str
    bands: tuple[Band | None, ...]  # one per resolution, or one for all; None: only reported
    reason: str
    unit: str = ""
    order: float | None = None  # least fitted order of convergence, where one is asked
    short: str = ""  # why the band is known to be missed; it stays what it is

    def band(self, level: int) -> Band | None:
        """The band of the resolution number `level`."""
        return self.bands[level] if len(self.bands) > 1 else self.bands[0]


@dataclass(frozen=True)
class Curve:
    """A line of the picture of a case."""

    label: str
    x: np.ndarray
    y: np.ndarray
    points: bool = False  # markers (measured or exact) instead of a line


def dots(label: str, x: np.ndarray, y: np.ndarray) -> Curve:
    """A curve that is drawn as markers."""
    return Curve(label, x, y, points=True)


@dataclass(frozen=True)
class Outcome:
    """What one run of a case gave."""

    values: Mapping[str, Value]  # by quantity
    curves: Sequence[Curve] = ()
    reference: Sequence[Curve] = ()  # the same at every resolution: drawn once


Run = Callable[[float], Outcome]  # of a resolution


@dataclass(frozen=True)
class Control:
    """A wrong model that must not pass: its run, and the quantity that must give it away."""

    what: str
    quantity: str
    run: Run


@dataclass(frozen=True)
class Case:
    """A validation case; `resolutions` are numbers of particles across `across`, coarse first."""

    name: str
    title: str
    across: str
    resolutions: tuple[float, ...]
    run: Run
    criteria: tuple[Criterion, ...]
    axes: tuple[str, str]  # of the picture
    controls: tuple[Control, ...] = ()

    def __post_init__(self) -> None:
        levels = len(self.resolutions)
        if list(self.resolutions) != sorted(set(self.resolutions)) or not levels:
            raise ValueError(f"{self.name}: resolutions must rise")
        for criterion in self.criteria:
            if len(criterion.bands) not in (1, levels):
                raise ValueError(f"{self.name}: {criterion.quantity} needs 1 or {levels} bands")
        for control in self.controls:
            self.criterion(control.quantity)

    def criterion(self, quantity: str) -> Criterion:
        """The criterion of a quantity; raises ValueError when it has none."""
        for criterion in self.criteria:
            if criterion.quantity == quantity:
                return criterion
        raise ValueError(f"{self.name}: no criterion for {quantity!r}")

    def resolutions_of(self, tier: str) -> tuple[float, ...]:
        """All resolutions, or only the coarsest."""
        return self.resolutions if tier == "full" else self.resolutions[:1]
