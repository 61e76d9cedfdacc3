"""Ways in which an HDF5 file can do harm: each takes the place of one of its datasets."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

SECRET = "secret.bin"  # beside the file: what must not be read
Harm = Callable[[h5py.File, str, int], None]  # file, name of the dataset, rows


def _secret(file: h5py.File) -> str:
    return str(Path(file.filename).with_name(SECRET))


def external_storage(file: h5py.File, name: str, rows: int) -> None:
    """The data are the bytes of another file."""
    file.create_dataset(name, (rows,), "f8", external=[(_secret(file), 0, 8 * rows)])


def virtual_dataset(file: h5py.File, name: str, rows: int) -> None:
    """The data are those of a dataset in another file."""
    layout = h5py.VirtualLayout((rows,), "f8")
    layout[:] = h5py.VirtualSource(_secret(file), "x", (rows,))
    file.create_virtual_dataset(name, layout)


def external_link(file: h5py.File, name: str, rows: int) -> None:
    """The dataset is one of another file."""
    file[name] = h5py.ExternalLink(_secret(file), "x")


def soft_link(file: h5py.File, name: str, rows: int) -> None:
    """The dataset is another one, or nothing."""
    file[name] = h5py.SoftLink("/elsewhere")


def data_not_there(file: h5py.File, name: str, rows: int) -> None:
    """Rows are claimed that were never written."""
    file.create_dataset(name, (10**8,), "f8")


def bomb(file: h5py.File, name: str, rows: int) -> None:
    """Chunks that were never written would unpack to 8 TB."""
    file.create_dataset(name, (10**12,), "f8", compression="gzip", chunks=(10**6,))


def packed_twice(file: h5py.File, name: str, rows: int) -> None:
    """Packed twice, a file holds a million times its size."""
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((10**7,))
    plan.set_deflate(9)
    plan.set_deflate(9)
    space = h5py.h5s.create_simple((10**7,))
    made = h5py.h5d.create(file.id, name.encode(), h5py.h5t.NATIVE_DOUBLE, space, plan)
    made.write(h5py.h5s.ALL, h5py.h5s.ALL, np.zeros(10**7))


def one_long_string(file: h5py.File, name: str, rows: int) -> None:
    """One string of 1 MB: a table of rows as wide as that would not fit."""
    words = np.array(["x" * 10**6] + ["x"] * (rows - 1), object)
    file.create_dataset(name, data=words, dtype=h5py.string_dtype())


def references(file: h5py.File, name: str, rows: int) -> None:
    """Objects in place of numbers."""
    file.create_dataset(name, data=[file.ref] * rows, dtype=h5py.ref_dtype)


def ragged(file: h5py.File, name: str, rows: int) -> None:
    """Rows of any length."""
    file.create_dataset(name, (rows,), h5py.vlen_dtype("f8"))


def a_group(file: h5py.File, name: str, rows: int) -> None:
    """A group that holds itself."""
    file.create_group(name)["again"] = file["/"]


HARMS: dict[str, Harm] = {
    harm.__name__: harm
    for harm in (
        external_storage, virtual_dataset, external_link, soft_link, data_not_there, bomb,
        packed_twice, one_long_string, references, ragged, a_group,
    )
}  # fmt: skip


def spoil(path: Path, name: str, harm: str) -> None:
    """Replace the dataset `name` of a whole file; a secret lies beside it."""
    path.with_name(SECRET).write_bytes(bytes(8 * 4000))
    with h5py.File(path, "r+") as file:
        rows = len(file[name])
        del file[name]
        HARMS[harm](file, name, rows)
