"""Checks and their verdicts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

GOOD, DOUBTFUL, BAD, NOT_AVAILABLE = "good", "doubtful", "bad", "not available"


@dataclass(frozen=True)
class Check:
    """One finding: `limits` are those of good and of doubtful; `counted` says of what."""

    name: str
    value: float | None
    limits: tuple[float, float]
    verdict: str
    counted: str
    remedy: str = ""  # empty where the verdict is good
    details: dict[str, float] = field(default_factory=dict)


def verdict(value: float, limits: tuple[float, float]) -> str:
    """Good, doubtful or bad; limits that fall are lower bounds.  What is not a number is bad."""
    sign = 1 if limits[1] > limits[0] else -1
    good, doubtful = (sign * value < sign * limit * (1 + sign * 1e-9) for limit in limits)
    return GOOD if good else DOUBTFUL if doubtful else BAD


def judged(
    name: str,
    value: float,
    limits: tuple[float, float],
    counted: str,
    remedy: str,
    **details: float,
) -> Check:
    found = verdict(value, limits)
    return Check(name, value, limits, found, counted, "" if found == GOOD else remedy, details)


def unknown(name: str, limits: tuple[float, float], why: str) -> Check:
    return Check(name, None, limits, NOT_AVAILABLE, why)


def max_of(values: list[float]) -> float:
    """The highest value; nan if any is nan."""
    return float(np.max(values))


def overall(checks: list[Check]) -> str:
    """The worst of the verdicts."""
    found = {check.verdict for check in checks}
    return next((word for word in (BAD, DOUBTFUL, GOOD) if word in found), NOT_AVAILABLE)
