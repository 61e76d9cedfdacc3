"""Columns of an HDF5 file, one dataset each, at the root or in the file's only group."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from ...errors import UserError
from ...util.foreign import readable
from ...util.hdf5 import Hdf5File, open_hdf5
from ...util.memory import available_bytes

LARGEST_STRING = 200  # bytes


def is_hdf5(path: Path) -> bool:
    """Whether the file begins like an HDF5 file."""
    with readable(path):
        return bool(h5py.is_hdf5(path))


def read_hdf5_columns(path: Path) -> dict[str, np.ndarray]:
    """Column name -> array (N,) of numbers or strings; raises UserError.

    Sizes are checked before anything is read, so a small file cannot unpack into a huge array.
    """
    with open_hdf5(path) as file:
        group, names = _folder_of_columns(file)
        columns = {name: file.dataset(group + name) for name in names}
        _check_shapes(path, columns)
        return {name: _values(file, group + name, columns[name]) for name in names}


def _folder_of_columns(file: Hdf5File) -> tuple[str, list[str]]:
    """The group that holds the columns, as the beginning of their names, and these."""
    group, names = "", file.names()
    if len(names) == 1 and file.holds_group(names[0]):
        group = f"{names[0]}/"
        names = file.names(group)
    if not names:
        raise UserError(f"{file.path}: holds no dataset; expected one per column")
    return group, names


def _check_shapes(path: Path, columns: dict[str, h5py.Dataset]) -> None:
    """That the columns are vectors of one length, and fit into memory together."""
    for name, column in columns.items():
        if column.ndim != 1:
            raise UserError(f'{path}: column "{name}" must have one dimension, not {column.ndim}')
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise UserError(f"{path}: the columns differ in length: {told}")
    claimed = sum(column.size * column.dtype.itemsize for column in columns.values())
    if claimed > available_bytes() / 4:
        raise UserError(
            f"{path}: claims {next(iter(lengths.values()))} particles, {claimed / 2**30:.3g} GiB, "
            "more than this machine can hold"
        )


def _values(file: Hdf5File, name: str, column: h5py.Dataset) -> np.ndarray:
    if h5py.check_string_dtype(column.dtype) is None:
        return column[:]
    return np.char.strip(file.words(name, LARGEST_STRING))
