"""Writing snapshots as VTKHDF files: PolyData with one vertex per particle (see vtkhdf.py)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from threading import get_ident
from typing import Any, NamedTuple

import h5py
import numpy as np

from .fields import FIELDS, GRAIN_FIELDS
from .vtkhdf import GRAINS, ROOT, VERSION, Header, location

# gzip, because VTK's own HDF5 library can undo it; level 1 costs 1-2 s for a million particles.
COMPRESSION = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
WORTH_PACKING = 2**19  # bytes of a file: some 2000 particles
CELLS, NO_CELLS = "Vertices", ("Lines", "Polygons", "Strips")


class Part(NamedTuple):
    """A dataset: its path in the file, its numbers, and their unit."""

    path: str
    values: np.ndarray
    unit: str = ""


class SnapshotWriter:
    """Writes the snapshots of a run, one after the other.

    Most of the time that a small file takes goes into the structure of HDF5, and from snapshot to
    snapshot only numbers change, as long as no particle comes or goes: then they are put into
    their places in the file before.
    """

    def __init__(self) -> None:
        self._form: object = None  # all but the numbers
        self._image = b""
        self._places: dict[str, int] = {}  # of the numbers in it

    def write(
        self,
        path: Path,
        state: Mapping[str, np.ndarray],
        header: Header,
        grains: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Write every field of FIELDS from `state`, of GRAIN_FIELDS from `grains`; raises OSError.

        The file is built in memory first (about 110 bytes a particle): when the disk fills up under
        HDF5's own writing, closing the file can crash the process.
        """
        parts = list(_parts(state, header, grains))
        if sum(part.values.nbytes for part in parts) >= WORTH_PACKING:
            path.write_bytes(_image(header, parts, COMPRESSION)[0])
            return
        kinds = [(part.path, part.values.shape, part.values.dtype) for part in parts]
        form = (header.dim, header.material_names, header.body_names, kinds)
        if form != self._form:
            self._form, (self._image, self._places) = form, _image(header, parts)
        image = bytearray(self._image)
        for part in parts:
            if part.values.size:
                first = self._places[part.path]
                image[first : first + part.values.nbytes] = part.values.tobytes()
        path.write_bytes(image)


def _parts(
    state: Mapping[str, np.ndarray], header: Header, grains: Mapping[str, np.ndarray] | None
) -> Iterator[Part]:
    """What a snapshot holds, but for its cells."""
    yield Part(f"{ROOT}/FieldData/Time", np.array([header.time]), "s")
    yield Part(f"{ROOT}/FieldData/Step", np.array([header.step]))
    yield Part(f"{ROOT}/FieldData/TimeStep", np.array([header.dt]), "s")
    for field in FIELDS:
        if field.absent is not None and field.key not in state:
            continue  # readers know what it is then
        yield Part(location(field), field.encode(state[field.key]), field.unit_in(header.dim))
    for field in GRAIN_FIELDS if grains else ():
        values = field.encode(grains[field.key]) if grains else np.zeros(0)
        yield Part(f"{GRAINS}/{field.file_name}", values, field.unit_in(header.dim))


def _image(
    header: Header, parts: Sequence[Part], packing: Mapping[str, Any] | None = None
) -> tuple[bytes, dict[str, int]]:
    """A file as bytes, and where in it the numbers of each part begin that is not packed."""
    options, places = packing or {}, {}
    name = f"image {get_ident()}"  # HDF5 opens no two files of one name: other threads have theirs
    with h5py.File(name, "w", driver="core", backing_store=False) as file:
        root = file.create_group(ROOT)
        root.attrs["Version"] = VERSION
        root.attrs["Type"] = np.bytes_("PolyData")
        root.attrs["Dimension"] = header.dim
        _write_names(root, "MaterialNames", header.material_names)
        _write_names(root, "BodyNames", header.body_names)
        for part in parts:
            packed = options if part.values.size > 1 else {}
            dataset = file.create_dataset(part.path, data=part.values, **packed)
            if part.unit:
                dataset.attrs["units"] = part.unit
            places[part.path] = dataset.id.get_offset()
        count = len(file[f"{ROOT}/Points"])
        root["NumberOfPoints"] = [count]
        _write_cells(root, CELLS, count, options)
        for kind in NO_CELLS:
            _write_cells(root, kind, 0, {})
        file.flush()
        return file.id.get_file_image(), places


def _write_names(root: h5py.Group, attribute: str, names: Sequence[str]) -> None:
    """Of a fixed length, so that a reader knows beforehand how much memory they take."""
    encoded = [name.encode() for name in names]
    longest = max(map(len, encoded), default=0) or 1
    kind = h5py.string_dtype("utf-8", longest)
    root.attrs.create(attribute, np.array(encoded, kind), (len(names),), kind)


def _write_cells(root: h5py.Group, kind: str, count: int, packing: Mapping[str, Any]) -> None:
    """One vertex per particle, so that filters on cells (threshold, clip) see single particles."""
    cells = root.create_group(kind)
    cells["NumberOfCells"] = cells["NumberOfConnectivityIds"] = [count]
    for name, values in (("Connectivity", np.arange(count)), ("Offsets", np.arange(count + 1))):
        cells.create_dataset(name, data=values, **(packing if values.size > 1 else {}))
