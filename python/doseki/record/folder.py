"""The names of the files in the output folder of a run, and the reading of its plain files."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError
from ..geodata.ground import ground_files
from ..util.foreign import read_text, readable

RASTERS = (".tif", ".asc")  # endings of rasters
MAP_FILES = (*RASTERS, ".prj", ".png", ".geojson", ".csv", ".json")
INPUTS = "inputs"  # folder of copies of the files that a scenario names


@dataclass(frozen=True)
class RunFolder:
    """Where everything about one run stands on the disk."""

    path: Path

    @property
    def scenario(self) -> Path:
        """The effective scenario."""
        return self.path / "scenario.toml"

    @property
    def inputs(self) -> Path:
        """The folder of copies of the files that the scenario names."""
        return self.path / INPUTS

    @property
    def lock(self) -> Path:
        """Held by the process that writes here."""
        return self.path / "lock"

    @property
    def prepared(self) -> RunFolder:
        """Where a new folder is made, before it gets its name with all that a run starts from."""
        return RunFolder(self.path.with_name(f".{self.path.name}.new"))

    @property
    def history(self) -> Path:
        """The table of diagnostics."""
        return self.path / "history.csv"

    @property
    def summary(self) -> Path:
        """What the run came to, for programs."""
        return self.path / "summary.json"

    @property
    def summary_text(self) -> Path:
        """What the run came to, for people."""
        return self.path / "summary.txt"

    @property
    def trust(self) -> Path:
        """How far the run can be trusted, for programs."""
        return self.path / "trust.json"

    @property
    def loads(self) -> Path:
        """Loads on structures, for programs."""
        return self.path / "loads.json"

    @property
    def loads_table(self) -> Path:
        """The same, for spreadsheets."""
        return self.path / "loads.csv"

    @property
    def series(self) -> Path:
        """The index of the snapshots that ParaView opens as one animation."""
        return self.path / "snapshots.vtkhdf.series"

    @property
    def log(self) -> Path:
        """The messages of the run."""
        return self.path / "log"

    @property
    def checkpoints(self) -> Path:
        """The folder of the states from which the run can go on."""
        return self.path / "checkpoints"

    @property
    def provenance(self) -> Path:
        """With what the run was computed."""
        return self.path / "provenance.json"

    @property
    def report(self) -> Path:
        """The report, where one was written."""
        return self.path / "report.html"

    @property
    def failure(self) -> Path:
        """Why the run failed, for programs."""
        return self.path / "failure.json"

    @property
    def snapshots(self) -> Path:
        """The folder of the snapshots."""
        return self.path / "snapshots"

    @property
    def gauges(self) -> Path:
        """The folder of what the gauges read."""
        return self.path / "gauges"

    def gauge(self, name: str) -> Path:
        """The file of a gauge."""
        return self.gauges / f"{name}.csv"

    @property
    def terrain(self) -> Path | None:
        """The bed as the run has it, a raster; None where it has none."""
        return next((path for path in ground_files(self.path) if path.suffix in RASTERS), None)

    @property
    def maps(self) -> Path:
        """The folder of maps: rasters, and pictures of them."""
        return self.path / "maps"

    @property
    def figures(self) -> Path:
        """The folder of the pictures."""
        return self.path / "figures"

    def links(self) -> list[Path]:
        """Symbolic links in the folder: what is read or written there would be somewhere else."""
        folders = (
            self.path,
            self.inputs,
            self.snapshots,
            self.figures,
            self.checkpoints,
            self.gauges,
            self.maps,
        )
        inside = [file for folder in folders if folder.is_dir() for file in folder.iterdir()]
        return sorted(file for file in inside if file.is_symlink())

    def refuse_links(self) -> None:
        """Raise UserError where reading or writing in the folder would do so outside it."""
        with readable(self.path):
            links = self.links()
        if links:
            raise UserError(
                f"{links[0]}: is a symbolic link; links in the folder of a run are not followed"
            )

    def is_run(self) -> bool:
        """Whether a run was recorded here."""
        return self.scenario.is_file() and self.snapshots.is_dir()

    def is_vacant(self) -> bool:
        """Whether nothing is here but what a run leaves that is killed before it has a scenario."""
        names = {file.name for file in self.path.iterdir()}
        began = {self.lock.name, self.inputs.name, self.snapshots.name, ".scenario.toml.part"}
        return names <= began and not any(self.snapshots.glob("*"))

    def remove(self) -> None:
        """Remove what a run has prepared here."""
        files = [self.lock, self.scenario, *self.path.glob(".*.part"), *self.inputs.glob("*")]
        for file in files:
            file.unlink(missing_ok=True)
        for folder in (self.inputs, self.snapshots, self.path):
            if folder.is_dir():
                folder.rmdir()

    def snapshot(self, number: int) -> Path:
        """File of snapshot `number`, counted from 0."""
        return self.snapshots / f"{number:06d}.vtkhdf"

    def snapshot_files(self) -> list[Path]:
        """The snapshots on the disk, in order of time."""
        files = self.snapshots.glob("*.vtkhdf")
        return sorted((f for f in files if re.fullmatch(r"\d{6,}", f.stem)), key=_number)

    def endings(self) -> list[Path]:
        """What says how a run goes on: reports of its end, then checkpoints, the newest first."""
        reports = (
            self.summary,
            self.summary_text,
            self.trust,
            self.failure,
            self.loads,
            self.loads_table,
        )
        checkpoints = sorted(self.checkpoints.glob("*.h5"), reverse=True)
        return [*(file for file in reports if file.exists()), *checkpoints]

    def recorded(self) -> list[Path]:
        """What a run may have written while it went on."""
        plain = (self.history, self.series, self.log, self.provenance, self.report)
        return [
            *(file for file in plain if file.exists()),
            *ground_files(self.path),
            *self.snapshot_files(),
            *self.gauges.glob("*.csv"),
            *self.figures.glob("*.png"),
            *(file for file in self.maps.glob("*") if file.suffix in MAP_FILES),
        ]


def _number(file: Path) -> int:
    return int(file.stem)


def read_history(path: Path) -> tuple[list[str], list[list[str]]]:
    """Column names and rows of a history or gauge file, without a last row cut short by a kill.

    Raises UserError where it is no table.
    """
    if not path.exists():
        return [], []
    text = read_text(path)
    whole_lines = text[: text.rfind("\n") + 1].splitlines()
    with readable(path):
        rows = list(csv.reader(whole_lines))
    for number, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            wrong = f"{len(row)} entries; the header has {len(rows[0])}"
            raise UserError(f"{path}: cannot be read: line {number} has {wrong}")
    return (rows[0], rows[1:]) if rows else ([], [])
