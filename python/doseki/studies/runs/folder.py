"""The folder of a study: what stands where, and whether what is there belongs to this study."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import UserError
from ...record.folder import RunFolder
from ...record.lock import FolderLock
from ...util.files import clear_errors, write_whole_text
from ...util.foreign import read_text
from ..plan.file import Plan, read_plan
from ..plan.sampling import Point
from .row import Row, read_row

FORMAT = 1
MAX_BYTES = 100_000_000
NAME = re.compile(r"(\d{4,})-([0-9a-f]{12})")


def digest(value: Any) -> str:
    """BLAKE2b of plain values, in 32 hexadecimal digits."""
    text = json.dumps(value, sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


@dataclass(frozen=True)
class RunPlace:
    """Where one run of a study is."""

    path: Path

    @property
    def record(self) -> RunFolder:
        """The folder of the run itself."""
        return RunFolder(self.path / "run")

    @property
    def job(self) -> Path:
        """What is to be run."""
        return self.path / "job.json"

    @property
    def row(self) -> Path:
        """What it came to."""
        return self.path / "row.json"

    @property
    def output(self) -> Path:
        """What the process said."""
        return self.path / "output.txt"

    def curve(self, band: str) -> Path:
        """What a band needs of it."""
        return self.path / f"band-{band}.csv"

    @property
    def number(self) -> int:
        """Of the run, from 0."""
        return int(self.path.name.partition("-")[0])


@dataclass(frozen=True)
class StudyFolder:
    """The folder of a study."""

    path: Path

    @property
    def study(self) -> Path:
        """The study file, as it was."""
        return self.path / "study.toml"

    @property
    def plan(self) -> Path:
        """What the runs here were made for."""
        return self.path / "plan.json"

    @property
    def runs(self) -> Path:
        """The folder of the runs."""
        return self.path / "runs"

    @property
    def stop(self) -> Path:
        """Whoever makes this file ends the study after the runs that go on."""
        return self.path / "STOP"

    @contextmanager
    def held(self) -> Iterator[None]:
        """Keep other processes from going on with the study; makes the folder."""
        if self.path.is_symlink() or (self.path.exists() and not self.path.is_dir()):
            raise UserError(f"{self.path}: is a link or a file, not a folder")
        with clear_errors(self.path):
            if self.path.is_dir():
                self._check_ours()
            self.path.mkdir(parents=True, exist_ok=True)
        lock = FolderLock(self.path)
        lock.take()
        try:
            yield
        finally:
            lock.release()

    def _check_ours(self) -> None:
        """Raise where the folder holds something, but no study."""
        names = {file.name for file in self.path.iterdir()}
        if names <= {"lock"} or self.plan.is_file():
            return
        raise UserError(
            f"{self.path}: exists and is not the folder of a study; give another one with -o"
        )

    def places(self) -> list[RunPlace]:
        """The runs that are there, by number; what else lies in the folder is left alone."""
        if self.runs.is_symlink():
            raise UserError(f"{self.runs}: is a symbolic link; nothing is written through it")
        if not self.runs.is_dir():
            return []
        found = [path for path in self.runs.iterdir() if NAME.fullmatch(path.name)]
        for path in found:
            if path.is_symlink() or not path.is_dir():
                raise UserError(f"{path}: is not a folder; nothing is written through it")
        return sorted((RunPlace(path) for path in found), key=lambda place: place.number)


class StudyRuns:
    """The runs of a plan in a folder: which are there, which are missing."""

    def __init__(self, folder: StudyFolder, plan: Plan) -> None:
        """Look at what is there; raises UserError where it is of another study."""
        self.folder, self.plan = folder, plan
        self._of_scenario = digest([plan.top.scenario, _stamp(plan)])
        self.reading = reading_digest(plan)
        with clear_errors(folder.path):
            self._check_same()
            self._begin()
        self._known = {place.path.name.partition("-")[2]: place for place in folder.places()}

    def place(self, point: Point) -> RunPlace:
        """Where the run at a point is, or will be; the next number is given to a new one."""
        key = digest([self._of_scenario, self.plan.settings_of(point)])[:12]
        if key not in self._known:
            number = 1 + max((place.number for place in self._known.values()), default=-1)
            place = RunPlace(self.folder.runs / f"{number:04d}-{key}")
            with clear_errors(place.path):
                place.path.mkdir(parents=True)
                job = {"settings": self.plan.settings_of(point), "values": list(point)}
                write_whole_text(place.job, json.dumps(job, indent=1) + "\n")
            self._known[key] = place
        return self._known[key]

    def row(self, place: RunPlace) -> Row | None:
        """What a run came to; None where it is missing or was read for something else."""
        row = read_row(place.row)
        return row if row is not None and row.reading == self.reading else None

    def __len__(self) -> int:
        return len(self._known)

    def _begin(self) -> None:
        self.folder.runs.mkdir(exist_ok=True)
        write_whole_text(self.folder.study, self.plan.text)
        write_whole_text(self.folder.plan, json.dumps(self._meaning(), indent=1) + "\n")

    def _meaning(self) -> dict[str, Any]:
        """What runs depend on, and what is read of them."""
        return {
            "format": FORMAT,
            "folder": str(self.plan.folder),
            "scenario": self._of_scenario,
            "set": self.plan.settings,
            "vary": [repr(axis) for axis in self.plan.axes],
            "points": digest([list(point) for point in self.plan.points()]),
            "reading": self.reading,
            "keep": self.plan.top.keep,
        }

    def _check_same(self) -> None:
        """Raise where runs of another study are here, which would be mixed with these."""
        if not self.folder.plan.exists():
            return
        before, now = _read_plan(self.folder.plan), self._meaning()
        what = {"vary": "[vary]", "set": "[set]", "scenario": "the scenario"}
        for key, words in what.items():
            if before.get(key) != now[key]:
                raise self._other(f"{words} has changed")
        if before.get("points") != now["points"] and not self._goes_on():
            raise self._other("[sample] has changed, and its points are others")
        if before.get("reading") != now["reading"] and before.get("keep") != "all":
            raise self._other(
                'what is read of runs has changed, and their records are gone (keep = "results")'
            )

    def _goes_on(self) -> bool:
        """Whether all runs that are there are among the points: then some are only added."""
        of_points = {
            digest([self._of_scenario, self.plan.settings_of(point)])[:12]
            for point in self.plan.points()
        }
        return {place.path.name.partition("-")[2] for place in self.folder.places()} <= of_points

    def _other(self, why: str) -> UserError:
        return UserError(
            f"{self.folder.path}: {why} since the runs here were made; give another folder with -o"
        )


def reading_digest(plan: Plan) -> str:
    """Of all that is read of a run, and of the files that it is compared with."""
    sections = (plan.results, plan.observations, plan.bands)
    tables = [
        [[name, part.model_dump(mode="json")] for name, part in section.items()]
        for section in sections
    ]
    files = {name: each.digest(plan.folder) for name, each in plan.observations.items()}
    return digest([tables, files])


def stored_plan(folder: StudyFolder) -> Plan:
    """The plan of a study that is in its folder; raises UserError where there is none."""
    return read_plan(folder.study, Path(str(_read_plan(folder.plan).get("folder", "."))))


def read_job(place: RunPlace) -> tuple[list[str], Sequence[Any]]:
    """The settings and the values of a run; raises UserError for a damaged file."""
    try:
        job = json.loads(read_text(place.job, MAX_BYTES))
        settings = [str(text) for text in job["settings"]]
        return settings, list(job["values"])
    except (ValueError, TypeError, KeyError):
        raise UserError(f"{place.job}: is damaged; remove {place.path}") from None


def _read_plan(path: Path) -> Mapping[str, Any]:
    try:
        found = json.loads(read_text(path, MAX_BYTES))
    except ValueError:
        found = None
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise UserError(f"{path}: is damaged, or of another version; give another folder with -o")
    return found


def _stamp(plan: Plan) -> str:
    """The scenario as it would run, with all that its file leaves to defaults."""
    return plan.scenario.effective_toml(stored=True)
