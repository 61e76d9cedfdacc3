"""Export to VTU, the format that viewers older than ParaView 5.12 read."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..errors import UserError
from ..util.files import clear_errors, write_whole, write_whole_text
from .fields import FIELDS
from .reader import Run, Snapshot

COLLECTION = "run.pvd"
VTK_VERTEX = 1
VTK_TYPES = {"float64": "Float64", "int32": "Int32", "int64": "Int64", "uint8": "UInt8"}
BYTE_ORDER = {"little": "LittleEndian", "big": "BigEndian"}[sys.byteorder]


def export_vtu(run: Run, out: str | Path | None = None) -> Path:
    """Write one .vtu for each snapshot and a .pvd with their times; returns the .pvd.

    They go to the folder `out` (default: DIR/vtu), which must not exist or be empty, and no link,
    or UserError is raised. It is there once it is whole.
    """
    folder = Path(out) if out is not None else run.directory / "vtu"
    with clear_errors(folder):
        if folder.is_symlink():
            raise UserError(f"{folder}: is a symbolic link; nothing is written through it")
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise UserError(f"{folder}: exists and is not empty; give another folder")
        unfinished = folder.with_name(f".{folder.name}.{os.getpid()}.part")
        unfinished.mkdir(parents=True)
    try:
        _write_all(run, unfinished)
        with clear_errors(folder):
            unfinished.replace(folder)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)
    return folder / COLLECTION


def _write_all(run: Run, folder: Path) -> None:
    entries = []
    for snapshot in run:
        file = folder / f"{snapshot.path.stem}.vtu"
        write_whole(file, partial(_write_vtu, snapshot))
        entries.append(f'<DataSet timestep="{snapshot.time!r}" file="{file.name}"/>')
    write_whole_text(folder / COLLECTION, _pvd(entries))


def _pvd(entries: Iterable[str]) -> str:
    return "\n".join(
        (
            '<?xml version="1.0"?>',
            '<VTKFile type="Collection" version="1.0">',
            "<Collection>",
            *entries,
            "</Collection>",
            "</VTKFile>",
            "",
        )
    )


def _write_vtu(snapshot: Snapshot, path: Path) -> None:
    """One unstructured grid of vertices; the arrays stand behind the XML as raw bytes."""
    blocks = _Blocks()
    n = len(snapshot.stored("id"))
    position, *others = FIELDS
    points = blocks.add(position.file_name, position.encode(snapshot.stored("position")))
    cells = (
        blocks.add("connectivity", np.arange(n)),
        blocks.add("offsets", np.arange(1, n + 1)),
        blocks.add("types", np.full(n, VTK_VERTEX, np.uint8)),
    )
    data = [
        blocks.add(field.file_name, field.encode(snapshot.stored(field.key))) for field in others
    ]
    xml = (
        '<?xml version="1.0"?>\n'
        f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{BYTE_ORDER}" '
        'header_type="UInt64">\n<UnstructuredGrid>\n'
        f'<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" '
        f'format="ascii">{snapshot.time!r}</DataArray></FieldData>\n'
        f'<Piece NumberOfPoints="{n}" NumberOfCells="{n}">\n'
        f"<Points>{points}</Points>\n<Cells>{''.join(cells)}</Cells>\n"
        f"<PointData>{''.join(data)}</PointData>\n"
        '</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_'
    )
    with path.open("wb") as file:
        file.write(xml.encode())
        blocks.write(file)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


class _Blocks:
    """Arrays to be appended to the XML: each is its length in bytes (UInt64), then its bytes."""

    def __init__(self) -> None:
        self._arrays: list[np.ndarray] = []
        self._offset = 0

    def add(self, name: str, array: np.ndarray) -> str:
        """Queue an array; returns the XML element that refers to it."""
        element = (
            f'<DataArray type="{VTK_TYPES[array.dtype.name]}" Name="{name}" '
            f'NumberOfComponents="{array.shape[1] if array.ndim > 1 else 1}" '
            f'format="appended" offset="{self._offset}"/>'
        )
        self._arrays.append(np.ascontiguousarray(array))
        self._offset += np.uint64(0).nbytes + array.nbytes
        return element

    def write(self, file: BinaryIO) -> None:
        """Write what was queued."""
        for array in self._arrays:
            file.write(np.uint64(array.nbytes).tobytes())
            file.write(array.tobytes())
