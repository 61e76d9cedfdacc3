#!/usr/bin/env python3
"""Reduce long instrument records to the knots of broken lines, which the package ships.

.venv/bin/python validation/references/reduce_measurements.py [FOLDER]

FOLDER holds the full records.  Prints the tables of kleefsman-2005-*.csv and
lobovsky-2014-sensor-*.csv of python/doseki/validate/data, and how far they are from the records.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "data"
SHARE = 0.25  # of its peak: where a pressure is said to arrive


@dataclass(frozen=True)
class Record:
    """Columns of an instrument record, and what is kept of them."""

    file: str
    delimiter: str | None
    columns: tuple[int, ...]  # after the time, which is column 0
    end: float  # the last time that a case compares, in the units of the file
    knots: int
    peak: int | None = None  # which of the columns keeps its peak and its arrival

    def read(self, folder: Path) -> tuple[np.ndarray, np.ndarray]:
        """Times (n,) and curves (n, columns) up to the end."""
        table = np.loadtxt(folder / self.file, delimiter=self.delimiter, skiprows=1)
        table = table[table[:, 0] <= self.end]
        return table[:, 0], table[:, list(self.columns)]

    def reduced(self, folder: Path) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of the knots."""
        times, curves = self.read(folder)
        keep = [] if self.peak is None else arrival_and_peak(curves[:, self.peak])
        return broken_line(times, curves, self.knots, keep)


KLEEFSMAN = "kleefsman_spheric2/test_case_2_exp_data.dat"
LOBOVSKY = "lobovsky2014/Fig31_Wemmenhove_sensor2_compared_graph.csv"
LOBOVSKY_OF = "lobovsky2014/lobovsky_H300_P{}.csv"
RECORDS = {
    "kleefsman-2005-p1.csv": Record(KLEEFSMAN, None, (1,), 6.001, 100, peak=0),
    "kleefsman-2005-p2-p4.csv": Record(KLEEFSMAN, None, (2, 3, 4), 2.001, 50, peak=0),
    "kleefsman-2005-p5-p6.csv": Record(KLEEFSMAN, None, (5, 6), 2.001, 66, peak=0),
    "kleefsman-2005-p7-p8.csv": Record(KLEEFSMAN, None, (7, 8), 2.001, 66, peak=0),
    "kleefsman-2005-levels.csv": Record(KLEEFSMAN, None, (10, 12), 6.001, 66),
    "kleefsman-2005-levels-h1-h3.csv": Record(KLEEFSMAN, None, (9, 11), 6.001, 66),
    "lobovsky-2014-sensor-2.csv": Record(LOBOVSKY, ",", (1, 2, 3), 6.51, 50, peak=1),
    "lobovsky-2014-sensor-3.csv": Record(LOBOVSKY_OF.format(3), ",", (1,), 6.51, 80, peak=0),
}


def arrival_and_peak(pressure: np.ndarray) -> list[int]:
    """The samples between which a pressure arrives, and that of its peak."""
    first = int(np.argmax(pressure >= SHARE * pressure.max()))
    return [first - 1, first, int(pressure.argmax())]


def broken_line(
    times: np.ndarray, curves: np.ndarray, count: int, keep: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """The best broken line of `count` knots; those in `keep` have the values of the record.

    Begins with the fewest knots and halves the piece with the largest squared error, counted in
    ranges of the curves.
    """
    knots, scale = sorted({0, len(times) - 1, *keep}), np.ptp(curves, axis=0)
    while True:
        hats = hat_functions(times, times[knots])
        values = fitted(hats, curves, np.isin(knots, keep), curves[knots])
        if len(knots) == count:
            return times[knots], values
        error = np.sum(((curves - hats @ values) / scale) ** 2, axis=1)
        worst = int(np.argmax(np.add.reduceat(error, knots[:-1]) * (np.diff(knots) > 1)))
        knots = sorted([*knots, (knots[worst] + knots[worst + 1]) // 2])


def hat_functions(times: np.ndarray, knots: np.ndarray) -> csr_array:
    """The matrix that turns values at knots into values at times."""
    piece = np.clip(np.searchsorted(knots, times, "right") - 1, 0, len(knots) - 2)
    share = (times - knots[piece]) / np.diff(knots)[piece]
    row = np.arange(len(times))
    entries = np.concatenate([1 - share, share])
    places = (np.tile(row, 2), np.concatenate([piece, piece + 1]))
    return csr_array((entries, places), shape=(len(times), len(knots)))


def fitted(hats: csr_array, curves: np.ndarray, fixed: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Values at the knots by least squares, where they are not fixed."""
    values = np.where(fixed[:, None], known, 0.0)
    free = hats[:, ~fixed]
    normal = (free.T @ free).tocsc()
    values[~fixed] = spsolve(normal, free.T @ (curves - hats @ values)).reshape(-1, curves.shape[1])
    return values


def main() -> None:
    """Print the tables and their errors."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    for name, record in RECORDS.items():
        times, values = record.reduced(folder)
        at, curves = record.read(folder)
        line = np.column_stack([np.interp(at, times, column) for column in values.T])
        print(f"\n{name}: mean error", np.mean(np.abs(line - curves), axis=0))
        for row in np.column_stack([times, values]):
            print(",".join(f"{number:.5g}" for number in row))


if __name__ == "__main__":
    main()
