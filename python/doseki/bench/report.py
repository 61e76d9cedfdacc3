"""The rows of `doseki bench` as tables, and as targets that hold or do not."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..compiled import DEVICES
from ..scenario.schemes import RESOLVED, UETA2022

Row = dict[str, Any]

MEMORY_LIMIT = 500  # bytes per particle in 3-D and double, lists included: more is an error
MEMORY_TARGET = 350
MEMORY_SIZE = 1_000_000  # particles, from which on the limit counts
LARGE, FLUME_SIZE = 100_000, 4_000
# Updates per second and core, in double, by scheme and dimensions.
LEAST_UPDATES = {UETA2022: {2: 3.0e6, 3: 0.9e6}, RESOLVED: {2: 5.0e6, 3: 1.5e6}}
LEAST_BARE_FRACTION = 0.5
LEAST_OVER_SCALAR = {"v4": 2.5, "v3": 1.8}
LEAST_MIXED_OVER_DOUBLE = 1.5
LEAST_TWO_THREADS, LEAST_TWO_THREADS_FLUME = 1.9, 1.6
EXPONENT_TOLERANCE = 0.05
GROWTH_FROM = 10_000  # particles


@dataclass(frozen=True)
class Check:
    """A measured number against the one it should reach."""

    name: str
    value: float
    bound: float
    sense: str = ">="

    @property
    def holds(self) -> bool:
        """Whether the target is reached."""
        if self.sense == "<=":
            return self.value <= self.bound
        return self.value >= self.bound

    def __str__(self) -> str:
        verdict = "holds" if self.holds else "MISSED"
        return f"{self.name}: {self.value:.3g} ({self.sense} {self.bound:.3g}: {verdict})"


def machine() -> str:
    """The processor and its caches, in words."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        name = next(
            line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")
        )
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    caches = [f"L{level} {size}" for level, size in _caches()]
    return ", ".join([name, *caches])


def _caches() -> Iterator[tuple[str, str]]:
    for index in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        if (index / "type").read_text().strip() != "Instruction":
            yield (index / "level").read_text().strip(), (index / "size").read_text().strip()


def _find(rows: Sequence[Row], **wanted: Any) -> Row | None:
    return next(
        (row for row in rows if all(row[key] == value for key, value in wanted.items())), None
    )


def _pairs_of_rows(
    rows: Sequence[Row], key: str, ours: Any, other: Any
) -> Iterator[tuple[Row, Row]]:
    """Rows that differ in nothing but `key`: `ours` and `other`."""
    same = {"dim", "precision", "n", "threads", "isa"} - {key}
    for row in rows:
        if row[key] == ours:
            found = _find(rows, **{key: other}, **{name: row[name] for name in same})
            if found:
                yield row, found


def _ratio(ours: Row, other: Row) -> float:
    return ours["updates_per_s"] / other["updates_per_s"]


def _label(row: Row) -> str:
    return f"{row['dim']}-D, {row['n']:.3g} particles"


def growth(rows: Sequence[Row]) -> list[tuple[str, float]]:
    """Exponent a of step time ~ N^a, for each kind of case timed at two sizes or more."""
    found = []
    kinds = dict.fromkeys(
        (row["dim"], row["precision"], row["threads"], row["isa"]) for row in rows
    )
    for dim, precision, threads, isa in kinds:
        wanted = {"dim": dim, "precision": precision, "threads": threads, "isa": isa}
        series = [row for row in rows if wanted.items() <= row.items() and row["n"] >= GROWTH_FROM]
        if len(series) > 1:
            sizes, seconds = (
                np.log([row[key] for row in series]) for key in ("n", "seconds_per_step")
            )
            name = f"{dim}-D {precision}, {threads} thread{'s' * (threads > 1)}, {isa}"
            found.append((name, float(np.polyfit(sizes, seconds, 1)[0])))
    return found


def _speed_checks(rows: Sequence[Row], isa: str) -> Iterator[Check]:
    for row in rows:
        if (row["precision"], row["threads"], row["n"], row["isa"]) == ("double", 1, LARGE, isa):
            updates = row["updates_per_s"]
            least = LEAST_UPDATES[row["scheme"]][row["dim"]]
            yield Check(f"updates/s of one core, {_label(row)}", updates, least)
            if row["bare_fraction"]:
                bare = row["bare_fraction"]
                yield Check(f"of the bare pair rate, {_label(row)}", bare, LEAST_BARE_FRACTION)


def _ratio_checks(rows: Sequence[Row], isa: str) -> Iterator[Check]:
    for ours, other in _pairs_of_rows(rows, "isa", isa, "scalar"):
        if isa in LEAST_OVER_SCALAR:
            bound = LEAST_OVER_SCALAR[isa]
            yield Check(f"{isa} over scalar, {_label(ours)}", _ratio(ours, other), bound)
    for ours, other in _pairs_of_rows(rows, "precision", "mixed", "double"):
        if ours["threads"] == 1 and ours["n"] >= LARGE:
            bound = LEAST_MIXED_OVER_DOUBLE
            yield Check(f"mixed over double, {_label(ours)}", _ratio(ours, other), bound)
    for ours, other in _pairs_of_rows(rows, "threads", 2, 1):
        bound = LEAST_TWO_THREADS if ours["n"] >= LARGE else LEAST_TWO_THREADS_FLUME
        if ours["precision"] == "double" and (ours["n"] >= LARGE or ours["n"] == FLUME_SIZE):
            yield Check(f"2 threads over 1, {_label(ours)}", _ratio(ours, other), bound)


def memory_check(rows: Sequence[Row], bound: float = MEMORY_LIMIT) -> Check | None:
    """The largest case that the limit counts for, if any was run; devices keep more of each."""
    wanted = {"dim": 3, "precision": "double", "scheme": UETA2022}
    large = [
        row
        for row in rows
        if wanted.items() <= row.items()
        and row["n"] >= MEMORY_SIZE
        and row["isa"] not in DEVICES.values()
    ]
    if not large:
        return None
    worst = max(large, key=lambda row: row["bytes_per_particle"])
    return Check(f"bytes per particle, {_label(worst)}", worst["bytes_per_particle"], bound, "<=")


def checks(rows: Sequence[Row]) -> list[Check]:
    """All targets that these rows tell something about."""
    isa = rows[0]["isa"] if rows else ""
    found = [*_speed_checks(rows, isa), *_ratio_checks(rows, isa)]
    for name, exponent in growth(rows):
        found.append(
            Check(f"growth exponent - 1, {name}", abs(exponent - 1), EXPONENT_TOLERANCE, "<=")
        )
    return found + [
        check for bound in (MEMORY_LIMIT, MEMORY_TARGET) if (check := memory_check(rows, bound))
    ]


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.0f} %"


KEYS: dict[str, Callable[[Row], str]] = {
    "dim": lambda row: str(row["dim"]),
    "precision": lambda row: row["precision"],
    "N": lambda row: f"{row['n']:.0e}".replace("e+0", "e"),
    "threads": lambda row: str(row["threads"]),
    "isa": lambda row: row["isa"],
}
COLUMNS: dict[str, Callable[[Row], str]] = KEYS | {
    "M updates/s": lambda row: f"{row['updates_per_s'] / 1e6:.2f}",
    "+-": lambda row: _percent(row["spread"] / 2),
    "cores had": lambda row: _percent(row["core_share"]),
    "M pairs/s/core": lambda row: f"{row['pairs_per_s'] / 1e6:.0f}",
    "of bare": lambda row: _percent(row["bare_fraction"]),
    "list/pair": lambda row: f"{row['list_to_pair']:.2f}",
    "bytes/particle": lambda row: f"{row['bytes_per_particle']:.0f}",
    "ms/step": lambda row: f"{1e3 * row['seconds_per_step']:.3g}",
    "MB": lambda row: f"{row['bytes_per_particle'] * row['n'] / 1e6:.3g}",
}


def markdown_table(header: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A table whose columns line up."""
    widths = [max(map(len, column)) for column in zip(header, *lines, strict=True)]
    rows = [header, ["-" * width for width in widths], *lines]
    return "\n".join(
        "| " + " | ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)) + " |"
        for row in rows
    )


def speed_table(rows: Sequence[Row]) -> str:
    """One line a row; MB is what a step goes through, to compare with the caches."""
    return markdown_table(list(COLUMNS), [[text(row) for text in COLUMNS.values()] for row in rows])


def phase_table(rows: Sequence[Row]) -> str:
    """Share of each phase in the time of a step, %."""
    phases = list(rows[0]["phases"])
    lines = []
    for row in rows:
        shares = [f"{100 * row['phases'][phase]:.1f}" for phase in phases]
        lines.append(
            [text(row) for text in KEYS.values()] + shares + [f"{row['steps_per_rebuild']:.0f}"]
        )
    return markdown_table([*KEYS, *phases, "steps per list"], lines)
