"""The table of a study: a row for each run, as CSV, JSON and, on request, Parquet."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...util.extras import extra
from ...util.files import write_whole, write_whole_text
from ..plan.file import Plan
from ..plan.sampling import Point
from ..runs.folder import RunPlace
from ..runs.row import DONE, Row


@dataclass(frozen=True)
class Entry:
    """A run of the table."""

    place: RunPlace
    point: Point
    row: Row


@dataclass(frozen=True)
class Table:
    """All runs of a study, by number."""

    plan: Plan
    entries: Sequence[Entry]

    @property
    def done(self) -> list[Entry]:
        """Those that were done."""
        return [entry for entry in self.entries if entry.row.status == DONE]

    def values(self, axis: int) -> np.ndarray:
        """Numbers (n,) of an axis, of the runs that were done; words by their place."""
        return np.array([self.plan.axes[axis].number(e.point[axis]) for e in self.done], float)

    def results(self, name: str) -> np.ndarray:
        """A result (n,) of the runs that were done."""
        return np.array([entry.row.results.get(name, np.nan) for entry in self.done], float)

    def scores(self) -> np.ndarray:
        """Scores (n,) of the runs that were done; nan where they have none."""
        return np.array([entry.row.score for entry in self.done], float)

    @property
    def is_scored(self) -> bool:
        """Whether any run has a score."""
        return bool(np.isfinite(self.scores()).any())

    def best(self) -> Entry | None:
        """The run that is nearest to the observations."""
        scored = [entry for entry in self.done if np.isfinite(entry.row.score)]
        return min(scored, key=lambda entry: entry.row.score, default=None)

    def columns(self) -> dict[str, list[Any]]:
        """Columns by header; None where a run has no value."""
        axes, units = self.plan.axes, self.plan.units()
        found: dict[str, list[Any]] = {
            "run": [entry.place.path.name for entry in self.entries],
            "status": [entry.row.status for entry in self.entries],
        }
        for k, axis in enumerate(axes):
            found[axis.label] = [axis.cell(entry.point[k]) for entry in self.entries]
        for name in self.plan.results:
            header = f"{name} [{units[name]}]" if units[name] else name
            found[header] = [_known(entry.row.results.get(name)) for entry in self.entries]
        for name in self.plan.observations:
            header = f"misfit {name}"
            found[header] = [_known(entry.row.misfits.get(name)) for entry in self.entries]
        if self.plan.observations:
            found["score"] = [_known(entry.row.score) for entry in self.entries]
        found["trust"] = [entry.row.trust or None for entry in self.entries]
        found["wall time [s]"] = [_known(entry.row.seconds) for entry in self.entries]
        found["reason"] = [entry.row.reason or None for entry in self.entries]
        return found


def write_table(table: Table, directory: Path) -> list[Path]:
    """Write results.csv, results.json and on request results.parquet; returns the files."""
    columns = table.columns()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        writer.writerow(["" if cell is None else cell for cell in row])
    files = [directory / "results.csv", directory / "results.json"]
    write_whole_text(files[0], text.getvalue())
    write_whole_text(files[1], json.dumps(_about(table, columns), indent=1) + "\n")
    if table.plan.top.parquet:
        files.append(directory / "results.parquet")
        _write_parquet(files[-1], columns)
    return files


def check_parquet() -> None:
    """Raise UserError where no Parquet file can be written."""
    with extra("parquet", "parquet = true"):
        import pyarrow.parquet  # noqa: F401


def _about(table: Table, columns: dict[str, list[Any]]) -> dict[str, Any]:
    """The same for programs: units apart from names."""
    plan = table.plan
    return {
        "title": plan.top.title,
        "scenario": plan.top.scenario,
        "set": plan.settings,
        "values": {axis.name: {"unit": axis.own_unit} for axis in plan.axes},
        "results": {name: {"unit": unit} for name, unit in plan.units().items()},
        "observations": list(plan.observations),
        "columns": columns,
    }


def _write_parquet(path: Path, columns: dict[str, list[Any]]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as parquet

    plain = {name: _of_one_type(values) for name, values in columns.items()}
    write_whole(path, lambda temporary: parquet.write_table(pa.table(plain), temporary))


def _of_one_type(values: list[Any]) -> list[Any]:
    """A column of Parquet has one type: numbers, or words."""
    given = [value for value in values if value is not None]
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in given):
        return [None if value is None else float(value) for value in values]
    return [None if value is None else str(value) for value in values]


def _known(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(value)
