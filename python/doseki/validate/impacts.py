"""What sensors see of an impact, against records that have been given the same bandwidth.

A raw peak is noise: one instant of one row of particles.  It is reported and not judged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..measure.series import arrival, impulse, peak
from ..util.low_pass import low_passed
from .case import Band, Criterion, Value, within
from .reference import read_columns
from .running import Running

FILTER = 20.0  # Hz, of the gauges of the scenarios and of the records
SAMPLES = 4000  # of a record, that is a broken line


@dataclass(frozen=True)
class Record:
    """A measured pressure: a column of a table, and what makes s and Pa of it."""

    file: str
    column: int = 1
    second: float = 1.0
    pascal: float = 1.0

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Times, s, and pressures, Pa, close together."""
        table = read_columns(self.file)
        knots = self.second * table[0]
        times = np.linspace(knots[0], knots[-1], SAMPLES)
        return times, self.pascal * np.interp(times, knots, table[self.column])


class Signals:
    """What the sensors of a run have seen, sample by sample."""

    def __init__(self, run: Running) -> None:
        self._run = run
        self._rows: dict[str, list[list[float]]] = {name: [] for name in run.sensors}

    def take(self) -> None:
        """A sample of all of them."""
        for name, sensor in self._run.sensors.items():
            self._rows[name].append(sensor.row())

    def of(self, name: str) -> np.ndarray:
        """Time, what it showed, highest since the sample before, raw, impulse: (5, samples)."""
        return np.array(self._rows[name]).T

    def values(self, name: str, record: Record, end: float, label: str) -> dict[str, Value]:
        """Impulse to `end`, s, peak at the bandwidth, arrival, and the raw peak."""
        times, shown, highest, raw, total = self.of(name)
        known, pressure = record.read()
        filtered = low_passed(known, pressure, FILTER)
        expected = impulse(known, pressure, 0, end)
        arrived = arrival(times, shown), arrival(known, filtered)
        return {
            f"{label}: impulse": Value(float(np.interp(end, times, total)), expected),
            f"{label}: peak at 20 Hz": Value(float(highest.max()), peak(known, filtered)[0]),
            f"{label}: arrival": Value(*arrived),
            f"{label}: raw peak": Value(peak(times, raw)[0], peak(known, pressure)[0]),
        }


def criteria_of(
    labels: Sequence[str], coarser: Mapping[str, Sequence[float | None]], short: Mapping[str, str]
) -> tuple[Criterion, ...]:
    """What is asked of each sensor: 10 % of impulse, 20 % of peak and 3 % of arrival where finest.

    `coarser` has the tolerances of coarser resolutions for these three (None: reported); `short`
    says of a quantity, by its whole name, why it misses its band.
    """
    asked = {"impulse": 0.1, "peak at 20 Hz": 0.2, "arrival": 0.03}
    reasons = {
        "impulse": "the integral of the pressure over every step",
        "peak at 20 Hz": "of gauge and record through the same low-pass of second order",
        "arrival": "when the filtered pressure first has a quarter of its peak",
    }
    units = {"impulse": "Pa s", "peak at 20 Hz": "Pa", "arrival": "s"}
    found = []
    for label in labels:
        for what, finest in asked.items():
            name = f"{label}: {what}"
            bands = tuple(_band(tolerance) for tolerance in (*coarser[what], finest))
            found.append(
                Criterion(name, bands, reasons[what], units[what], short=short.get(name, ""))
            )
        why = "one instant of one row of particles: noise, not a quantity"
        found.append(Criterion(f"{label}: raw peak", (None,), why, "Pa"))
    return tuple(found)


def _band(tolerance: float | None) -> Band | None:
    return None if tolerance is None else within(tolerance)
