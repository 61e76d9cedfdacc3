"""What the sums over pairs do on a device, beside what a card can do at best.

The core counts the operations of a pair by running the code of the pair on numbers that count
(core/python/counted.hpp), and the bytes from the records that a neighbour is read from.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..compiled import DEVICES, Peaks, card_peaks, load_core
from ..solver.protocol import CoreSimulation
from .case import Case
from .report import KEYS, markdown_table

Row = dict[str, Any]

SLOW = ("quotients", "roots")
ARITHMETIC = ("sums", "products", *SLOW)  # comparisons are left out
LEAST_OF_ROOF = 0.5  # of what a card can do at best


def work_of(
    case: Case, simulation: CoreSimulation, updates: float, shares: Mapping[str, float]
) -> list[Row]:
    """Of each sum, on a device: what a pair takes, and what was done in a second of the sum.

    `updates` are those per second, `shares` those of phases in the time of a step.  Every entry of
    a list is summed there.
    """
    if case.isa not in DEVICES.values():
        return []
    pairs = updates * simulation.entries_per_particle
    rows = []
    for work in load_core(case.isa).pair_work(case.scheme, case.dim, case.precision, False):
        operations = sum(work[name] for name in ARITHMETIC)
        rate = pairs / shares[work["sum"]]
        rows.append(
            {
                "sum": work["sum"],
                "operations_per_pair": operations,
                "slow_per_pair": sum(work[name] for name in SLOW),
                "bytes_per_pair": work["bytes"],
                "operations_per_s": rate * operations,
                "bytes_per_s": rate * work["bytes"],
            }
        )
    return rows


def share_of_roof(work: Row, peaks: Peaks, precision: str) -> float:
    """Time that the card would take at best, by its arithmetic or its memory, over that taken."""
    arithmetic = peaks.in_double if precision == "double" else peaks.in_float
    return float(max(work["operations_per_s"] / arithmetic, work["bytes_per_s"] / peaks.bandwidth))


def _roof(work: Row, peaks: Peaks | None, row: Row) -> str:
    if peaks is None or row["isa"] != DEVICES["cuda"]:
        return ""
    return f"{100 * share_of_roof(work, peaks, row['precision']):.0f} %"


def work_table(rows: Sequence[Row], peaks: Peaks | None) -> str:
    """One line for each sum; bytes are those that threads ask for, from caches or memory."""
    header = [
        *KEYS, "sum", "operations/pair", "of them / and sqrt", "bytes/pair", "G operations/s",
        "GB/s", "of roof",
    ]  # fmt: skip
    lines = [
        [text(row) for text in KEYS.values()]
        + [
            work["sum"],
            f"{work['operations_per_pair']}",
            f"{work['slow_per_pair']}",
            f"{work['bytes_per_pair']}",
            f"{work['operations_per_s'] / 1e9:.3g}",
            f"{work['bytes_per_s'] / 1e9:.3g}",
            _roof(work, peaks, row),
        ]
        for row in rows
        for work in row["work"]
    ]
    return markdown_table(header, lines)


def roofline(peaks: Peaks | None) -> str:
    """What the card can do at best, in words."""
    if peaks is None:
        return "Roof: there is no graphics card here"
    return (
        f"Roof: {peaks.in_double / 1e12:.3g} (double) and {peaks.in_float / 1e12:.3g} (mixed)"
        f" T operations/s, {peaks.bandwidth / 1e12:.3g} TB/s;"
        f" a sum should reach {100 * LEAST_OF_ROOF:.0f} % of the lower one"
    )


def print_work(rows: Sequence[Row]) -> None:
    """The table of rows that were timed on a device, if there are any."""
    if any(row["work"] for row in rows):
        peaks = card_peaks()
        print(f"\nPairs\n\n{work_table(rows, peaks)}\n\n{roofline(peaks)}")
