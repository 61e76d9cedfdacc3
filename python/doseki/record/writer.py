"""The record of a run: an output folder that grows while the run goes on."""

from __future__ import annotations

import json
import math
import time as clock
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from ..errors import UserError
from ..util.files import clear_errors, sync, write_whole, write_whole_text
from ..util.input_file import InputFile
from .beginning import begin
from .folder import RunFolder, read_history
from .snapshot_writer import SnapshotWriter
from .vtkhdf import Header, read_header

SERIES_SECONDS = 1.0  # after which the index of snapshots follows them, while a run goes on


class Recorder:
    """Writes the folder of a run: scenario, snapshots, history, summary.

    Each snapshot is whole or absent, each history row is written at once: a run that is killed
    leaves a folder that can be loaded.  Where the machine goes down, what was written since the
    last `sync` may be gone.  Every method raises ResourceError when the disk is full
    and UserError when it may not be written to.
    """

    def __init__(
        self,
        directory: str | Path,
        scenario_text: str,
        material_names: Sequence[str],
        body_names: Sequence[str],
        dim: int,
        overwrite: bool = False,
        inputs: Sequence[InputFile] = (),
    ) -> None:
        """Start a new record in `directory`; raises UserError if something is there already.

        `scenario_text` is the effective scenario, which names `inputs` by their names in the
        folder; the other names are those that the fields `material` and `body` of the snapshots
        index.  With `overwrite` an earlier run is removed first.
        """
        folder = RunFolder(Path(directory))
        begin(folder, scenario_text, inputs, overwrite)
        self._attach(folder, material_names, body_names, dim)

    @classmethod
    def reopen(
        cls,
        directory: str | Path,
        snapshots: int,
        rows: int,
        gauge_rows: Mapping[str, int] = MappingProxyType({}),
    ) -> Recorder:
        """Go on with the record of a resumed run: keep its first snapshots and rows."""
        folder = RunFolder(Path(directory))
        folder.refuse_links()
        files = folder.snapshot_files()
        if not files:
            raise UserError(f"{directory}: holds no snapshot from which a run could go on")
        if len(files) < snapshots or len(read_history(folder.history)[1]) < rows:
            raise UserError(f"{directory}: snapshots or rows have gone since the checkpoint")
        for name, count in gauge_rows.items():
            if len(read_history(folder.gauge(name))[1]) < count:
                raise UserError(f"{folder.gauge(name)}: rows have gone since the checkpoint")
        # Later ones are written anew: what a machine that went down has made of them is no matter.
        headers = {file: read_header(file) for file in files[: max(1, snapshots)]}
        first = headers[files[0]]
        recorder = cls.__new__(cls)
        recorder._attach(folder, first.material_names, first.body_names, first.dim)
        with clear_errors(folder.path):
            ended = (folder.summary, folder.summary_text, folder.trust, folder.failure)
            for file in ended:
                file.unlink(missing_ok=True)
            for file in files[snapshots:]:
                file.unlink()
        recorder._index = [recorder._entry(file, headers[file].time) for file in files[:snapshots]]
        recorder._write_series()
        _truncate(folder.history, rows)
        recorder._columns = read_history(folder.history)[0]
        for file in folder.gauges.glob("*.csv"):
            _truncate(file, gauge_rows.get(file.stem, 0))
        return recorder

    def _attach(
        self,
        folder: RunFolder,
        material_names: Sequence[str],
        body_names: Sequence[str],
        dim: int,
    ) -> None:
        self._folder = folder
        self._material_names = tuple(material_names)
        self._body_names = tuple(body_names)
        self._dim = dim
        self._index: list[str] = []  # an entry of the series for each snapshot
        self._series_at = -math.inf  # s, by the clock, when it was last written
        self._snapshots = SnapshotWriter()
        self._unsafe: list[Path] = []  # snapshots that may not be on the disk yet
        self._columns: list[str] = []

    @property
    def directory(self) -> Path:
        """The folder that is written."""
        return self._folder.path

    def snapshot(
        self,
        state: Mapping[str, np.ndarray],
        *,
        time: float,
        step: int,
        dt: float,
        grains: Mapping[str, np.ndarray] | None = None,
    ) -> Path:
        """Write one snapshot and return its file.

        `state` holds every field of fields.FIELDS under its Python name and shape, SI units;
        `time` and `dt` are in s; `grains` holds every field of fields.GRAIN_FIELDS.
        """
        header = Header(time, step, dt, self._dim, self._material_names, self._body_names)
        file = self._folder.snapshot(len(self._index))
        # Waiting for the disk each time would take longer than all else about a small snapshot.
        write_whole(file, lambda part: self._snapshots.write(part, state, header, grains), False)
        self._unsafe.append(file)
        self._index.append(self._entry(file, time))
        # Taking the place of a file makes the system write at once, which takes milliseconds.
        if clock.monotonic() - self._series_at > SERIES_SECONDS:
            self._write_series()
        return file

    def history(self, row: Mapping[str, float]) -> None:
        """Append one row; the first row gives the columns, the others must have the same ones."""
        lines = [[_number_text(value) for value in row.values()]]
        if not self._columns:
            self._columns = list(row)
            lines.insert(0, self._columns)
        if list(row) != self._columns:
            raise ValueError(f"history columns changed from {self._columns} to {list(row)}")
        path = self._folder.history
        with clear_errors(path), path.open("a", encoding="utf-8") as file:
            file.write(_csv(lines))

    def gauge(self, name: str, header: Sequence[str], rows: Sequence[Sequence[float]]) -> None:
        """Append rows of a gauge; the first ones come after the header, "name [unit]" each."""
        path = self._folder.gauge(name)
        lines = [[_number_text(value) for value in row] for row in rows]
        with clear_errors(path):
            path.parent.mkdir(exist_ok=True)
            if not path.is_file() or path.stat().st_size == 0:
                lines.insert(0, list(header))
            with path.open("a", encoding="utf-8") as file:
                file.write(_csv(lines))

    def sync(self) -> None:
        """Put the record safely on the disk: a checkpoint never knows more than is there."""
        tables = self._folder.history, self._folder.series, *self._folder.gauges.glob("*.csv")
        self._sync_snapshots()
        self._write_series()
        for path in tables:
            with clear_errors(path):
                sync(path)

    def close(self, summary: Mapping[str, Any]) -> None:
        """Write `summary` (numbers, words, lists and dicts of them): the run has ended."""
        self._sync_snapshots()
        self._write_series()
        text = json.dumps(jsonable(summary), indent=2, allow_nan=False) + "\n"
        write_whole_text(self._folder.summary, text)

    def _sync_snapshots(self) -> None:
        names = [self._folder.snapshots] if self._unsafe else []
        for path in [*self._unsafe, *names]:
            with clear_errors(path):
                sync(path)
        self._unsafe.clear()

    def _entry(self, file: Path, time: float) -> str:
        return json.dumps({"name": f"{self._folder.snapshots.name}/{file.name}", "time": time})

    def _write_series(self) -> None:
        """It can be told from the snapshots, so it need not be on the disk with each of them."""
        files = ",\n".join(self._index)
        index = f'{{"file-series-version": "1.0", "files": [\n{files}\n]}}\n'
        write_whole_text(self._folder.series, index, safely=False)
        self._series_at = clock.monotonic()


def _truncate(path: Path, count: int) -> None:
    """Keep the header and the first rows of a table; without any row, nothing."""
    columns, rows = read_history(path)
    if columns:
        write_whole_text(path, _csv([columns, *rows[:count]]) if count else "")


def _csv(rows: Sequence[Sequence[str]]) -> str:
    return "".join(",".join(row) + "\n" for row in rows)


def _number_text(value: float) -> str:
    """Shortest text that reads back as the same number."""
    return str(int(value)) if isinstance(value, int | np.integer) else repr(float(value))


def jsonable(value: Any) -> Any:
    """The same in types that JSON has; a number that is not finite becomes null."""
    if isinstance(value, Mapping):
        return {str(key): jsonable(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [jsonable(entry) for entry in value]
    if isinstance(value, np.generic):
        return jsonable(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
