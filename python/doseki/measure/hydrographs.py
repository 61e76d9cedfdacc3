"""What the record of a section amounts to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Passage:
    """A flow that crosses a section.

    Attributes:
        arrival: time at which the section is first seen wet, s; None where it stays dry, as below
            a film, which has discharge and no depth.
        peak: largest discharge, m3/s.
        peak_time: of that, s.
        depth, speed: largest means over the wet section, m and m/s.
        volume: that has passed downstream, m3, by the trapezoidal rule.

    """

    arrival: float | None
    peak: float
    peak_time: float
    depth: float
    speed: float
    volume: float


def passage(record: Mapping[str, np.ndarray]) -> Passage:
    """Of the columns of a gauge of kind "section"; it has one row at least."""
    time, discharge = record["time"], record["discharge"]
    wet = record["width"] > 0
    largest = int(np.argmax(np.abs(discharge)))
    volume = float(np.sum(np.diff(time) * (discharge[1:] + discharge[:-1]) / 2))
    return Passage(
        float(time[wet][0]) if wet.any() else None,
        float(discharge[largest]),
        float(time[largest]),
        float(np.max(record["depth"][wet], initial=0.0)),
        float(np.max(np.abs(record["speed"][wet]), initial=0.0)),
        volume,
    )
