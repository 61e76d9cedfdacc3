"""The run that a scenario starts from: which of its files, and what they say."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UserError
from ..record.folder import RunFolder
from ..record.reader import Snapshot, load
from ..record.vtkhdf import read_header
from ..util.finding import Finding
from ..util.foreign import read_toml_table
from ..util.input_file import digest_of
from ..util.sealed import changed_by_hand
from .tables.start import Start
from .values.toml_source import MAX_BYTES, Where

SAME = 1e-9  # relative difference of two times that are meant to be one


@dataclass(frozen=True)
class NearestSnapshot(Finding):
    """A time for which there is no snapshot."""

    time: float  # s, that was asked for
    taken: float  # s

    def __str__(self) -> str:
        return (
            f"start.time = {self.time:g} s lies between two snapshots; the one at {self.taken:g} s "
            "is taken"
        )


@dataclass(frozen=True)
class ChangedByHand(Finding):
    """A scenario that is not the one that the earlier run had."""

    said: str

    def __str__(self) -> str:
        return f"start.from: {self.said}"


@dataclass(frozen=True)
class Earlier:
    """A snapshot of another run, with its scenario and, where it is still there, a checkpoint."""

    scenario_file: Path
    snapshot: Snapshot
    checkpoint: Path | None
    asked: float | None = None  # s, by the user

    @property
    def time(self) -> float:
        """Simulated time of the snapshot, s, at which the clock goes on."""
        return self.snapshot.time

    @property
    def files(self) -> list[Path]:
        """All that the new run needs of the earlier one."""
        found = [self.scenario_file, self.snapshot.path]
        return found if self.checkpoint is None else [*found, self.checkpoint]

    @property
    def findings(self) -> list[Finding]:
        """A time that is not that of a snapshot, a scenario that has been changed."""
        said = changed_by_hand(self.scenario_file)
        found: list[Finding] = [ChangedByHand("start", said)] if said else []
        asked = self.time if self.asked is None else self.asked
        if abs(asked - self.time) > SAME * max(asked, self.time):
            found.append(NearestSnapshot("start", asked, self.time))
        return found

    @cached_property
    def scenario(self) -> dict[str, Any]:
        """The effective scenario of the earlier run, as its file has it."""
        return read_toml_table(self.scenario_file, MAX_BYTES)

    def section(self, name: str) -> dict[str, Any]:
        """Tables of a section of that scenario; none where the file has something else."""
        found = self.scenario.get(name)
        return found if isinstance(found, dict) else {}


def earlier_run(start: Start, where: Where) -> Earlier:
    """What [start] names; raises UserError where that is no run, or has no such time."""
    folder = where.folder(("start", "from"))
    try:
        if isinstance(start.folder, str):
            return _in_folder(folder / start.folder, start.time)
        files = [folder / name for name in start.folder]
        _check_digests(files, start.digests)
        scenario, snapshot, *more = files
        found = Snapshot(snapshot, read_header(snapshot))
        return Earlier(scenario, found, more[0] if more else None, start.time)
    except UserError as error:
        raise where.error(("start", "from"), f"start.from: {error}") from None


def _in_folder(folder: Path, time: float | None) -> Earlier:
    """The snapshot nearest to a time, s, of the run in a folder; without one the last."""
    run = load(folder)
    times = run.times
    if len(times) == 0:
        raise UserError(f"{folder}: the run has no snapshot yet")
    wanted = float(times[-1]) if time is None else time
    margin = SAME * float(times.max())
    if not times.min() - margin <= wanted <= times.max() + margin:
        raise UserError(
            f"time = {wanted:g} s is outside the record of {folder}, which has snapshots from "
            f"{times.min():g} to {times.max():g} s"
        )
    snapshot = run[int(np.argmin(np.abs(times - wanted)))]
    files = RunFolder(folder)
    checkpoint = files.checkpoints / f"{snapshot.step:012d}.h5"
    return Earlier(files.scenario, snapshot, checkpoint if checkpoint.is_file() else None, time)


def _check_digests(files: list[Path], digests: list[str] | None) -> None:
    for file, expected in zip(files, digests or [], strict=False):
        if digest_of(file) != expected:
            raise UserError(
                f"{file} is not the file that was meant: its digest is {digest_of(file)}, expected "
                f"{expected}"
            )
