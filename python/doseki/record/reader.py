"""Reading a recorded run: `doseki.load(DIR)`."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from numbers import Real
from pathlib import Path
from typing import Any, TypeVar, overload

import numpy as np

from ..errors import UserError
from ..geodata.ground import Profile, read_ground
from ..geodata.raster import Raster
from ..util.foreign import REMEDY, read_json_table, readable
from ..util.spelling import suggestion
from . import vtkhdf
from .between import Between
from .fields import FIELD_BY_KEY, GRAIN_FIELDS
from .folder import RunFolder, read_history
from .history import history_units
from .particles import FIXED
from .scenario_file import recorded_scenario

H = TypeVar("H", bound="History")
G = TypeVar("G", bound="GaugeRecord")
ROUNDING = 1e-6  # of the time between two snapshots: the same time


def load(directory: str | Path) -> Run:
    """The run recorded in `directory`; raises UserError if there is none.

    Nothing but the names of its files is read until it is asked for; a run that is still going on
    can be loaded, too.
    """
    folder = RunFolder(Path(directory))
    if not folder.path.is_dir():
        wrong = "is a file; give the folder of a run" if folder.path.exists() else "no such folder"
        raise UserError(f"{directory}: {wrong}")
    if not folder.is_run():
        raise UserError(
            f"{directory}: not the folder of a run: {folder.scenario.name} or "
            f"{folder.snapshots.name}/ is missing"
        )
    folder.refuse_links()
    return Run(folder)


class Snapshot(Mapping[str, np.ndarray]):
    """The particles at one time: a mapping from field name to array, SI units, read when asked.

    The names are those of fields.FIELDS and `fixed` (bool).  `material` and `body` are arrays of
    names; vectors are (N, dim), tensors (N, 3, 3).
    """

    def __init__(self, path: Path, header: vtkhdf.Header) -> None:
        self.path = path
        self.time = header.time
        self.step = header.step
        self.dt = header.dt
        self.dim = header.dim
        self.material_names = header.material_names
        self.body_names = header.body_names
        self._arrays: dict[str, np.ndarray] = {}
        self._stored: dict[str, np.ndarray] = {}

    def __getitem__(self, key: str) -> np.ndarray:
        if key not in self._arrays:
            self._arrays[key] = self._read(key)
        return self._arrays[key]

    def __iter__(self) -> Iterator[str]:
        return iter((*FIELD_BY_KEY, "fixed"))

    def __len__(self) -> int:
        return len(FIELD_BY_KEY) + 1

    def _read(self, key: str) -> np.ndarray:
        if key == "fixed":
            return self["motion"] == FIXED
        if key not in FIELD_BY_KEY:
            raise KeyError(f"{key!r} is not a field of a snapshot{suggestion(key, self)}")
        names = {"material": self.material_names, "body": self.body_names}.get(key)
        stored = self.stored(key)
        return stored if names is None else self._named(names, stored)

    def stored(self, key: str) -> np.ndarray:
        """A field as in the file, where `material` and `body` are indices of their names."""
        if key not in self._stored:
            self.prefetch([key])
        return self._stored[key]

    def prefetch(self, keys: Iterable[str]) -> None:
        """Read fields at once, which takes less time than one by one."""
        fields = [FIELD_BY_KEY[key] for key in keys]
        self._stored |= vtkhdf.read_fields(self.path, fields, self.dim)

    @cached_property
    def grains(self) -> dict[str, np.ndarray]:
        """The bodies that move, by the keys of fields.GRAIN_FIELDS; empty where there are none.

        `body` is an array of names; row k is what the field `grain` of a particle says.
        """
        table = vtkhdf.read_grains(self.path, self.dim)
        return table | {"body": self._named(self.body_names, table["body"])} if table else {}

    def overlaps(self) -> np.ndarray:
        """The field `overlap` of the bodies that move, read alone."""
        (column,) = (field for field in GRAIN_FIELDS if field.key == "overlap")
        table = vtkhdf.read_grains(self.path, self.dim, [column])
        return table.get("overlap", np.zeros(0))

    def _named(self, names: Sequence[str], index: np.ndarray) -> np.ndarray:
        if len(index) and not 0 <= index.min() <= index.max() < len(names):
            raise UserError(f"{self.path}: an index is outside the {len(names)} names")
        return np.array(names, dtype=str)[index]


class MissingColumnError(UserError, KeyError):
    """A table of a record has no such column: the name is wrong, or the file is damaged."""

    def __init__(self, path: str | Path, column: str, known: Sequence[str]) -> None:
        said = (
            f"is not a column{suggestion(column, known)}" if known else "is no column: it is empty"
        )
        super().__init__(f"{path}: {column!r} {said}")

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError quotes it


class GaugeRecords(dict[str, G]):
    """What gauges read, by their names."""

    def __missing__(self, name: object) -> G:
        raise MissingGaugeError(name, self)


class MissingGaugeError(UserError, KeyError):
    """A record has no gauge of this name."""

    def __init__(self, name: object, known: Iterable[str]) -> None:
        said = suggestion(name, known) or "; the run has none"
        super().__init__(f"{name!r} is not a gauge of the run{said}")

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError quotes it


class History(Mapping[str, np.ndarray]):
    """The diagnostics of a run: a mapping from column name to the values over time."""

    def __init__(
        self, columns: Sequence[str], rows: Sequence[Sequence[str]], path: str | Path
    ) -> None:
        self.path = path  # of its file
        self.columns = list(columns)
        self.units: dict[str, str] = history_units(self.columns)
        """Unit of each column; "" where it has none."""
        try:
            table = np.array([[float(cell) for cell in row] for row in rows])
        except ValueError:
            raise UserError(_no_number(path, self.columns, rows)) from None
        self._table = table.reshape(len(rows), len(self.columns))

    def __getitem__(self, column: str) -> np.ndarray:
        if column not in self.columns:
            raise MissingColumnError(self.path, column, self.columns)
        return self._table[:, self.columns.index(column)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)


def _no_number(path: str | Path, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """What is wrong with rows of which one entry is no number."""
    for line, row in enumerate(rows, start=2):
        for column, cell in zip(columns, row, strict=True):
            try:
                float(cell)
            except ValueError:
                return (
                    f"{path}, line {line}: {column} = {cell[:40]!r} is not a number; the file is "
                    "damaged: bring it back"
                )
    return f"{path}: is damaged; bring it back"


class GaugeRecord(History):
    """What a gauge read: a mapping from column name to an array (N,), in `units`.

    A velocity profile has one row for each sample and height.
    """

    def __init__(
        self, columns: Sequence[str], rows: Sequence[Sequence[str]], path: str | Path
    ) -> None:
        """`columns` as in the file, "name [unit]" each; one without a unit is none of a gauge."""
        parts = [column.removesuffix("]").partition(" [") for column in columns]
        super().__init__([name for name, _, _ in parts], rows, path)
        self.units = {name: unit for name, _, unit in parts}


class Run(Sequence[Snapshot]):
    """A recorded run: a sequence of snapshots in order of time, with its history and scenario."""

    def __init__(self, folder: RunFolder) -> None:
        self.folder = folder

    @cached_property
    def _headers(self) -> list[tuple[Path, vtkhdf.Header]]:
        found = [(path, vtkhdf.read_header(path)) for path in self.folder.snapshot_files()]
        for path, header in found:
            if not math.isfinite(header.time):
                raise UserError(f"{path}: its time, {header.time:g} s, is not finite; {REMEDY}")
        for (before, one), (path, other) in pairwise(found):
            # A run that fails at once leaves two of one time.
            if other.time < one.time:
                raise UserError(
                    f"{path}: its time, {other.time:.9g} s, is before that of {before.name}, "
                    f"{one.time:.9g} s: one of the two is a copy, or of another run; move it away"
                )
        return found

    def __len__(self) -> int:
        return len(self._headers)

    @overload
    def __getitem__(self, index: int) -> Snapshot: ...

    @overload
    def __getitem__(self, index: slice) -> list[Snapshot]: ...

    def __getitem__(self, index: int | slice) -> Snapshot | list[Snapshot]:
        """Snapshot `index` (negative: from the end), or a list of them for a slice.

        Each call gives a new Snapshot, so that its arrays go when the caller drops it.
        """
        if isinstance(index, slice):
            return [Snapshot(*entry) for entry in self._headers[index]]
        return Snapshot(*self._headers[index])

    @property
    def directory(self) -> Path:
        """The folder of the run."""
        return self.folder.path

    @cached_property
    def ground(self) -> Raster | Profile | None:
        """The ground of a run on a terrain, else None."""
        return read_ground(self.folder.path)

    @property
    def times(self) -> np.ndarray:
        """Times of the snapshots, s."""
        return np.array([header.time for _, header in self._headers])

    @overload
    def at(self, time: float, *, nearest: bool = False) -> Snapshot: ...

    @overload
    def at(self, time: float, *, interpolate: bool) -> Snapshot | Between: ...

    def at(
        self, time: float, *, nearest: bool = False, interpolate: bool = False
    ) -> Snapshot | Between:
        """The snapshot of `time`, s.

        Between two it is the nearer one, with a warning that says which unless `nearest`; or with
        `interpolate` the particles between them.  Raises UserError for a time outside the record.
        """
        if not self._headers:
            raise UserError(f"{self.directory}: the run has no snapshot yet")
        given: Any = time
        if isinstance(given, bool) or not isinstance(given, Real):
            raise UserError(f"time = {given!r}; allowed: a number, in s")
        times = self.times
        found = int(np.argmin(np.abs(times - time)))
        rounding = ROUNDING * (times[-1] - times[0]) / len(times)
        if abs(times[found] - time) <= rounding:
            return self[found]
        if not times[0] <= time <= times[-1]:
            raise UserError(
                f"{self.directory}: {time:g} s is outside the record, which goes from "
                f"{times[0]:g} to {times[-1]:g} s"
            )
        if interpolate:
            later = int(np.searchsorted(times, time))
            ends = times[later - 1], times[later]
            return Between(time, ends, (self[later - 1], self[later]), self.periods())
        if not nearest:
            warnings.warn(
                f"{self.directory}: no snapshot at {time:g} s, took that of {times[found]:g} s;"
                " nearest=True takes it without a word, interpolate=True goes between two",
                stacklevel=2,
            )
        return self[found]

    def periods(self) -> list[tuple[int, float, float]]:
        """Each periodic axis with the ends of the domain, m."""
        axes = ["xyz".index(axis) for axis in self.scenario.get("periodic", [])]
        ends = [self.scenario.get(key, []) for key in ("domain_min", "domain_max")]
        return [(axis, float(ends[0][axis]), float(ends[1][axis])) for axis in axes]

    @cached_property
    def history(self) -> History:
        """The diagnostics."""
        return self._history(History)

    def _history(self, kind: type[H]) -> H:
        with readable(self.folder.history):
            return kind(*read_history(self.folder.history), self.folder.history)

    @cached_property
    def gauges(self) -> Mapping[str, GaugeRecord]:
        """What the gauges read, by their names."""
        return self._gauges(GaugeRecord)

    def _gauges(self, kind: type[G]) -> dict[str, G]:
        records: GaugeRecords[G] = GaugeRecords()
        for file in sorted(self.folder.gauges.glob("*.csv")):
            with readable(file):
                records[file.stem] = kind(*read_history(file), file)
        return records

    @cached_property
    def scenario(self) -> dict[str, Any]:
        """The effective scenario; raises UserError where the file is damaged."""
        return recorded_scenario(self.folder.scenario)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What the run came to; empty while it is going on."""
        if not self.folder.summary.is_file():
            return {}
        found = read_json_table(self.folder.summary)
        for key, kind, what in (("status", str, "a word"), ("warnings", list, "a list")):
            if not isinstance(found.get(key, kind()), kind):
                raise UserError(
                    f"{self.folder.summary}: is damaged: {key} = {str(found[key])[:40]} must be "
                    f"{what}; {REMEDY}"
                )
        return found

    @cached_property
    def trust(self) -> dict[str, Any]:
        """How far the run can be trusted (trust.json); empty while it is going on."""
        if not self.folder.trust.is_file():
            return {}
        return read_json_table(self.folder.trust)
