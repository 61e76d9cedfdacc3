"""One snapshot as a VTKHDF file, as snapshot_writer.py writes it (ParaView, VTK, h5py)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import UserError
from ..util.hdf5 import Hdf5File, open_hdf5
from .fields import GRAIN_FIELDS, ParticleField

VERSION = (2, 0)  # of the VTKHDF format: PolyData is read by VTK >= 9.3, ParaView >= 5.12
ROOT, GRAINS = "VTKHDF", "Grains"  # groups


@dataclass(frozen=True)
class Header:
    """What a snapshot file says besides its fields; the names are indexed by material and body."""

    time: float
    step: int
    dt: float
    dim: int
    material_names: tuple[str, ...]
    body_names: tuple[str, ...]


@contextmanager
def _snapshot_file(path: Path) -> Iterator[Hdf5File]:
    """An open snapshot; errors about it say how to read the others."""
    try:
        with open_hdf5(path) as file:
            yield file
    except UserError as error:
        raise UserError(f"{error}; move it away to read the rest of the run") from None


def read_header(path: Path) -> Header:
    """Read what `write` stored beside the fields; raises UserError for other files."""
    with _snapshot_file(path) as file:
        dim = file.attribute(ROOT, "Dimension")
        if dim not in (2, 3):
            raise file.error("Dimension", f"is {dim}; expected 2 or 3")
        return Header(
            time=float(file.number(f"{ROOT}/FieldData/Time")),
            step=int(file.number(f"{ROOT}/FieldData/Step")),
            dt=float(file.number(f"{ROOT}/FieldData/TimeStep")),
            dim=int(dim),
            material_names=tuple(file.attribute(ROOT, "MaterialNames")),
            body_names=tuple(file.attribute(ROOT, "BodyNames")),
        )


def read_fields(path: Path, fields: Sequence[ParticleField], dim: int) -> dict[str, np.ndarray]:
    """Read fields by their keys, shaped as in Python.

    Raises UserError for what `write` does not write.
    """
    with _snapshot_file(path) as file:
        count = len(file.dataset(f"{ROOT}/Points"))
        return {field.key: _field(file, field, location(field), count, dim) for field in fields}


def _field(file: Hdf5File, field: ParticleField, name: str, count: int, dim: int) -> np.ndarray:
    if field.absent is not None and name not in file:
        return np.full(count, field.absent, field.dtype)
    return _decoded(file, name, field, count, dim)


def read_grains(
    path: Path, dim: int, fields: Sequence[ParticleField] = GRAIN_FIELDS
) -> dict[str, np.ndarray]:
    """Columns of the table of bodies that move, by their keys; empty where there are none.

    Raises UserError where the table is missing.
    """
    with _snapshot_file(path) as file:
        if GRAINS not in file:
            _check_no_bodies(file)
            return {}
        count = len(file.dataset(f"{GRAINS}/Position"))
        return {f.key: _field(file, f, f"{GRAINS}/{f.file_name}", count, dim) for f in fields}


def _check_no_bodies(file: Hdf5File) -> None:
    """Raise UserError where particles of a file without a table of bodies belong to one."""
    name = f"{ROOT}/PointData/Grain"
    if name in file and (file.numbers(name) >= 0).any():
        raise file.error(GRAINS, "is missing, the table of the bodies that its particles are of")


def _decoded(file: Hdf5File, name: str, field: ParticleField, count: int, dim: int) -> np.ndarray:
    """A field of `count` rows, shaped as in Python."""
    stored = file.numbers(name)
    if stored.shape != (count, *field.columns) or stored.dtype.kind not in "iu" + field.dtype[0]:
        rows = " x ".join(map(str, (count, *field.columns)))
        raise file.error(name, f"must hold {rows} numbers ({field.dtype})")
    return field.decode(stored, dim)


def location(field: ParticleField) -> str:
    """Where in a file a field of particles stands."""
    return f"{ROOT}/{'' if field.key == 'position' else 'PointData/'}{field.file_name}"
