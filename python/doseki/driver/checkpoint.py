"""Checkpoints: the whole state of a run in one file, from which it goes on to the same bits."""

from __future__ import annotations

import hashlib
import io
import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path

import h5py
import numpy as np

from ..errors import UserError
from ..util.files import clear_errors, write_whole

VERSION = 2
KEPT = 2  # files; the older one serves where the newer one is damaged
DIGEST_BYTES = 64


@dataclass
class Position:
    """Where a run stands in its record, so that nothing is recorded twice or left out."""

    outputs: int = 0  # intervals of time_out that are done with, the start included
    snapshots: int = 0  # recorded
    rows: int = 0  # of the history
    gauge_rows: dict[str, int] = field(default_factory=dict)  # never changed in place
    next_history: float = 0.0  # s
    next_checkpoint: float = 0.0  # s
    wall_seconds: float = 0.0


@dataclass
class Checkpoint:
    """A state of the core (its arrays by name) and what the run around it must remember."""

    state: dict[str, np.ndarray]
    position: Position
    material_names: list[str]
    body_names: list[str]

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self.state["time"][0])

    @property
    def step(self) -> int:
        """Steps done."""
        return int(self.state["steps"][0])

    @property
    def is_of_many_ranks(self) -> bool:
        """Whether several ranks wrote it: it has no lists, which any number of ranks make anew."""
        return int(self.state["lanes"][0]) == 0


class DamagedCheckpointError(Exception):
    """A file that is not, or no longer, a whole checkpoint."""


def to_bytes(checkpoint: Checkpoint) -> memoryview:
    """The checkpoint as an HDF5 file, then its BLAKE2b digest (HDF5 ignores what follows)."""
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        said = {
            "version": VERSION,
            "position": asdict(checkpoint.position),
            "material_names": checkpoint.material_names,
            "body_names": checkpoint.body_names,
        }
        file.attrs["doseki"] = json.dumps(said)
        for name, values in checkpoint.state.items():
            file.create_dataset(name, data=values)
    digest = hashlib.blake2b(image.getbuffer()).digest()
    image.seek(0, io.SEEK_END)
    image.write(digest)
    return image.getbuffer()


def from_bytes(data: bytes) -> Checkpoint:
    """What `to_bytes` wrote; raises DamagedCheckpointError for anything else.

    The digest is looked at before HDF5 sees the data: damaged files can crash it.
    """
    content, digest = data[:-DIGEST_BYTES], data[-DIGEST_BYTES:]
    if len(data) < 2 * DIGEST_BYTES or hashlib.blake2b(content).digest() != digest:
        raise DamagedCheckpointError("its checksum is wrong")
    with h5py.File(io.BytesIO(content), "r") as file:
        said = json.loads(file.attrs["doseki"])
        if said["version"] != VERSION:
            raise DamagedCheckpointError(f"it has format {said['version']}, expected {VERSION}")
        state = {name: dataset[...] for name, dataset in file.items()}
    return Checkpoint(
        state, Position(**said["position"]), said["material_names"], said["body_names"]
    )


class CheckpointFolder:
    """The checkpoints of a run on the disk, the last KEPT of them."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def files(self) -> list[Path]:
        """The checkpoints, in order of steps."""
        return sorted(self.path.glob("[0-9]*.h5"))

    def write(self, checkpoint: Checkpoint) -> Path:
        """Put a checkpoint safely on the disk, then drop those that are too old.

        Raises ResourceError when the disk is full; the earlier ones are untouched then.
        """
        data = to_bytes(checkpoint)
        file = self.path / f"{checkpoint.step:012d}.h5"
        with clear_errors(self.path):
            self.path.mkdir(exist_ok=True)
        write_whole(file, lambda temporary: temporary.write_bytes(data))
        for old in self.files()[:-KEPT]:
            old.unlink(missing_ok=True)
        return file

    def read_last(self, until: float = math.inf) -> tuple[Checkpoint, list[str]]:
        """The newest whole checkpoint at a time of at most `until`, s, and a sentence about each
        damaged one that was passed over.

        Raises UserError when there is none.
        """
        notes: list[str] = []
        for file in reversed(self.files()):
            try:
                checkpoint = from_bytes(file.read_bytes())
                if checkpoint.time <= until:
                    return checkpoint, notes
            except (DamagedCheckpointError, OSError) as error:
                notes.append(f"{file} is damaged ({error}); using the one before it")
        found = f": {notes[0]}" if notes else ""
        raise UserError(f"{self.path}: no whole checkpoint to go on from{found}; run it again")

    def drop_later(self, step: int) -> None:
        """Remove what was written after `step`: damaged files, or states the run now replaces."""
        with clear_errors(self.path):
            for file in self.files():
                if int(file.stem) > step:
                    file.unlink()
