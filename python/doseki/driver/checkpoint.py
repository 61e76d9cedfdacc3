"""Checkpoints: the whole state of a run in one file, from which it goes on to the same bits."""

from __future__ import annotations

import hashlib
import io
import json
import math
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import h5py
import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from ..errors import UserError
from ..util.files import clear_errors, write_whole
from ..util.finding import rounded_up
from ..util.foreign import read_bytes
from ..util.hdf5 import open_hdf5

VERSION = 14
KEPT = 2  # files; the older one serves where the newer one is damaged
DIGEST_BYTES = 64
AROUND_STATE = "doseki"  # JSON, as bytes
MAP = "map_"  # before the names of arrays that are not of the core


Count = Annotated[int, Field(ge=0, le=2**53)]
Time = Annotated[float, Field(ge=0)]  # s; infinite: never


@dataclass
class Position:
    """Where a run stands in its record, so that nothing is recorded twice or left out."""

    outputs: Count = 0  # intervals of time_out that are done with, the start included
    snapshots: Count = 0  # recorded
    rows: Count = 0  # of the history
    gauge_rows: dict[str, Count] = field(default_factory=dict)  # never changed in place
    next_checkpoint: Time = 0.0
    wall_seconds: Time = 0.0
    sensors: dict[str, list[float]] = field(default_factory=dict)  # state by name of the gauge


@dataclass
class Beginning:
    """What was known of a run when it began, and its stored scenario does not say."""

    warnings: list[str] = field(default_factory=list)  # about its scene and its first state
    # The key by which the reduced sound speed was given, and its value.
    sound_speed_from: dict[str, float] = field(default_factory=dict)


@dataclass
class Checkpoint:
    """A state of the core (its arrays by name) and what the run around it must remember."""

    state: dict[str, np.ndarray]
    position: Position
    material_names: list[str]
    body_names: list[str]
    maps: dict[str, np.ndarray] = field(default_factory=dict)  # state of measure.maps.peaks
    scenario: str | None = None  # identity of its run; None: it does not say
    beginning: Beginning = field(default_factory=Beginning)

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


@dataclass
class Around:
    """What a checkpoint file says beside the state."""

    version: int
    position: Position
    material_names: list[str]
    body_names: list[str]
    scenario: str | None = None
    beginning: Beginning = field(default_factory=Beginning)


AROUND: TypeAdapter[Around] = TypeAdapter(Around)


def to_bytes(checkpoint: Checkpoint) -> memoryview:
    """The checkpoint as an HDF5 file, then its BLAKE2b digest (HDF5 ignores what follows)."""
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        said = {
            "version": VERSION,
            "position": asdict(checkpoint.position),
            "material_names": checkpoint.material_names,
            "body_names": checkpoint.body_names,
            "scenario": checkpoint.scenario,
            "beginning": asdict(checkpoint.beginning),
        }
        # No attribute, which holds 64 kB at most.
        file[AROUND_STATE] = np.frombuffer(json.dumps(said).encode(), np.uint8)
        of_maps = {f"{MAP}{name}": values for name, values in checkpoint.maps.items()}
        for name, values in (checkpoint.state | of_maps).items():
            file.create_dataset(name, data=values)
    digest = hashlib.blake2b(image.getbuffer()).digest()
    image.seek(0, io.SEEK_END)
    image.write(digest)
    return image.getbuffer()


def from_bytes(data: bytes, path: Path) -> Checkpoint:
    """What `to_bytes` wrote, read from `path`; raises DamagedCheckpointError for anything else.

    The digest is looked at before HDF5 sees the data: damaged files can crash it. Whoever makes a
    digest anew may still mean harm: nothing outside the file is read, and what the arrays hold is
    checked against the scenario (solver.restoring).
    """
    content, digest = data[:-DIGEST_BYTES], data[-DIGEST_BYTES:]
    if len(data) < 2 * DIGEST_BYTES or hashlib.blake2b(content).digest() != digest:
        raise DamagedCheckpointError("its checksum is wrong")
    with open_hdf5(path, content) as file:
        said = json.loads(file.numbers(AROUND_STATE).tobytes())
    if said.get("version") != VERSION:
        raise DamagedCheckpointError(
            f"it is of another version of doseki: format {said.get('version')}, here {VERSION}"
        )
    with open_hdf5(path, content) as file:
        try:
            around = AROUND.validate_python(said)
        except ValidationError as error:
            first = error.errors()[0]
            place = ".".join(map(str, first["loc"]))
            said = f"is wrong: {str(first['input'])[:40]} cannot be there"
            raise file.error(place, said) from None
        state = {name: file.numbers(name) for name in file.names() if name != AROUND_STATE}
    maps = {name: state.pop(name) for name in list(state) if name.startswith(MAP)}
    for name in ("time", "steps", "lanes"):
        if name not in state or state[name].shape != (1,):
            raise UserError(f'{path}: "{name}" is missing, or not one number')
    names = around.material_names, around.body_names
    maps = {name.removeprefix(MAP): values for name, values in maps.items()}
    return Checkpoint(state, around.position, *names, maps, around.scenario, around.beginning)


class CheckpointFolder:
    """The checkpoints of a run on the disk, the last KEPT of them."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def files(self) -> list[Path]:
        """The checkpoints, in order of steps."""
        files = self.path.glob("*.h5")
        found = [file for file in files if re.fullmatch(r"\d{12,18}", file.stem)]
        return sorted(found, key=lambda file: int(file.stem))

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
        damaged: list[str] = []
        later: list[float] = []
        for file in reversed(self.files()):
            try:
                checkpoint = from_bytes(read_bytes(file), file)
                if checkpoint.time <= until:
                    return checkpoint, [f"{each}; using the one before it" for each in damaged]
                later.append(checkpoint.time)
            except (DamagedCheckpointError, UserError) as error:
                said = str(error).removeprefix(f"{file}: ")
                damaged.append(f"{file} is damaged ({said})")
        found = f": {damaged[0]}" if damaged else ""
        if not later:
            raise UserError(f"{self.path}: no whole checkpoint to go on from{found}; run it again")
        times = " and ".join(f"{rounded_up(time, 6):g} s" for time in reversed(later))
        raise UserError(
            f"{self.path}: no whole checkpoint at a time of at most {until:g} s{found}; "
            f"checkpoints are at {times}"
        )

    def drop_later(self, step: int) -> None:
        """Remove what was written after `step`: damaged files, or states the run now replaces."""
        with clear_errors(self.path):
            for file in self.files():
                if int(file.stem) > step:
                    file.unlink()
