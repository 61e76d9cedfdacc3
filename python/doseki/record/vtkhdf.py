"""One snapshot as a VTKHDF file: PolyData with one vertex per particle (ParaView, VTK, h5py)."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..util.hdf5 import Hdf5File, open_hdf5
from .fields import FIELDS, GRAIN_FIELDS, ParticleField

VERSION = (2, 0)  # of the VTKHDF format: PolyData is read by VTK >= 9.3, ParaView >= 5.12
# gzip, because VTK's own HDF5 library can undo it; level 1 costs 1-2 s for a million particles.
COMPRESSION = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
CELL_KINDS = ("Vertices", "Lines", "Polygons", "Strips")


@dataclass(frozen=True)
class Header:
    """What a snapshot file says besides its fields; the names are indexed by material and body."""

    time: float
    step: int
    dt: float
    dim: int
    material_names: tuple[str, ...]
    body_names: tuple[str, ...]


def write(
    path: Path,
    state: Mapping[str, np.ndarray],
    header: Header,
    grains: Mapping[str, np.ndarray] | None = None,
) -> None:
    """Write every field of FIELDS from `state`, of GRAIN_FIELDS from `grains`; raises OSError.

    The file is built in memory first (about 110 bytes a particle): when the disk fills up under
    HDF5's own writing, closing the file can crash the process.
    """
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = VERSION
        root.attrs["Type"] = np.bytes_("PolyData")
        _write_header(root, header)
        _write_cells(root, len(state["position"]))
        root.create_group("PointData")
        for field in FIELDS:
            values, unit = field.encode(_values(state, field)), field.unit_in(header.dim)
            _write_array(root, _location(field), values, unit)
        if grains:
            table = file.create_group("Grains")
            for field in GRAIN_FIELDS:
                values, unit = field.encode(grains[field.key]), field.unit_in(header.dim)
                _write_array(table, field.file_name, values, unit)
    path.write_bytes(image.getbuffer())


def read_header(path: Path) -> Header:
    """Read what `write` stored beside the fields; raises UserError for other files."""
    with open_hdf5(path) as file:
        dim = file.attribute("VTKHDF", "Dimension")
        if dim not in (2, 3):
            raise file.error("Dimension", f"is {dim}; expected 2 or 3")
        return Header(
            time=float(file.number("VTKHDF/FieldData/Time")),
            step=int(file.number("VTKHDF/FieldData/Step")),
            dt=float(file.number("VTKHDF/FieldData/TimeStep")),
            dim=int(dim),
            material_names=tuple(file.attribute("VTKHDF", "MaterialNames")),
            body_names=tuple(file.attribute("VTKHDF", "BodyNames")),
        )


def _values(state: Mapping[str, np.ndarray], field: ParticleField) -> np.ndarray:
    if field.absent is not None and field.key not in state:
        return np.full(len(state["position"]), field.absent)
    return state[field.key]


def read_field(path: Path, field: ParticleField, dim: int) -> np.ndarray:
    """Read one field, shaped as in Python; raises UserError for what `write` does not write."""
    with open_hdf5(path) as file:
        name, count = f"VTKHDF/{_location(field)}", len(file.dataset("VTKHDF/Points"))
        if field.absent is not None and name not in file:
            return np.full(count, field.absent, field.dtype)
        return _decoded(file, name, field, count, dim)


def read_grains(path: Path, dim: int) -> dict[str, np.ndarray]:
    """The table of bodies that move, by the keys of GRAIN_FIELDS; empty where there are none."""
    with open_hdf5(path) as file:
        if "Grains" not in file:
            return {}
        count = len(file.dataset("Grains/Position"))
        return {f.key: _decoded(file, f"Grains/{f.file_name}", f, count, dim) for f in GRAIN_FIELDS}


def _decoded(file: Hdf5File, name: str, field: ParticleField, count: int, dim: int) -> np.ndarray:
    """A field of `count` rows, shaped as in Python."""
    stored = file.numbers(name)
    if stored.shape != (count, *field.columns) or stored.dtype.kind not in "iu" + field.dtype[0]:
        rows = " x ".join(map(str, (count, *field.columns)))
        raise file.error(name, f"must hold {rows} numbers ({field.dtype})")
    return field.decode(stored, dim)


def _location(field: ParticleField) -> str:
    return field.file_name if field.key == "position" else f"PointData/{field.file_name}"


def _write_header(root: h5py.Group, header: Header) -> None:
    root.attrs["Dimension"] = header.dim
    _write_names(root, "MaterialNames", header.material_names)
    _write_names(root, "BodyNames", header.body_names)
    data = root.create_group("FieldData")
    for name, value, unit in (
        ("Time", header.time, "s"),
        ("Step", header.step, ""),
        ("TimeStep", header.dt, "s"),
    ):
        _write_array(data, name, np.array([value]), unit)


def _write_names(root: h5py.Group, attribute: str, names: Sequence[str]) -> None:
    """Of a fixed length, so that a reader knows beforehand how much memory they take."""
    encoded = [name.encode() for name in names]
    longest = max(map(len, encoded), default=0) or 1
    kind = h5py.string_dtype("utf-8", longest)
    root.attrs.create(attribute, np.array(encoded, kind), (len(names),), kind)


def _write_cells(root: h5py.Group, n: int) -> None:
    """One vertex per particle, so that filters on cells (threshold, clip) see single particles."""
    root.create_dataset("NumberOfPoints", data=[n])
    for kind in CELL_KINDS:
        count = n if kind == "Vertices" else 0
        cells = root.create_group(kind)
        cells.create_dataset("NumberOfCells", data=[count])
        cells.create_dataset("NumberOfConnectivityIds", data=[count])
        _write_array(cells, "Connectivity", np.arange(count))
        _write_array(cells, "Offsets", np.arange(count + 1))


def _write_array(group: h5py.Group, name: str, values: np.ndarray, unit: str = "") -> None:
    options: dict[str, Any] = COMPRESSION if values.size > 1 else {}
    dataset = group.create_dataset(name, data=values, **options)
    if unit:
        dataset.attrs["units"] = unit
