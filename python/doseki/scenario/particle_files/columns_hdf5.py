"""Columns of an HDF5 file, one dataset each, at the root or in the file's only group."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from ...errors import UserError
from ...util.memory import available_bytes

LARGEST_STRING = 200  # bytes


def is_hdf5(path: Path) -> bool:
    """Whether the file begins like an HDF5 file."""
    return h5py.is_hdf5(path)


def read_hdf5_columns(path: Path) -> dict[str, np.ndarray]:
    """Column name -> array (N,) of numbers or strings; raises UserError.

    Sizes are checked before anything is read, so a small file cannot unpack into a huge array.
    """
    try:
        with h5py.File(path, "r") as file:
            return _read(path, _folder_of_columns(path, file))
    except UserError:
        raise
    except Exception as error:
        # A damaged file makes h5py raise almost anything.
        raise UserError(f"{path}: cannot be read as HDF5: {error}") from None


def _members(path: Path, group: h5py.Group) -> dict[str, h5py.Group | h5py.Dataset]:
    """What the group itself holds; links into other places are refused."""
    for name in group:
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise UserError(f'{path}: "{name}" is a link; expected a dataset')
    return dict(group.items())


def _folder_of_columns(path: Path, file: h5py.File) -> dict[str, h5py.Dataset]:
    members = _members(path, file)
    groups = [member for member in members.values() if isinstance(member, h5py.Group)]
    if len(members) == 1 and groups:
        members = _members(path, groups[0])
    for name, member in members.items():
        if not isinstance(member, h5py.Dataset):
            raise UserError(f'{path}: "{name}" is not a dataset; expected one dataset per column')
    if not members:
        raise UserError(f"{path}: holds no dataset; expected one per column")
    return members


def _read(path: Path, columns: dict[str, h5py.Dataset]) -> dict[str, np.ndarray]:
    lengths = {name: _length(path, name, column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise UserError(f"{path}: the columns differ in length: {told}")
    claimed = sum(column.size * column.dtype.itemsize for column in columns.values())
    if claimed > available_bytes() / 4:
        raise UserError(
            f"{path}: claims {next(iter(lengths.values()))} particles, {claimed / 2**30:.3g} GiB, "
            "more than this machine can hold"
        )
    return {name: _values(column) for name, column in columns.items()}


def _length(path: Path, name: str, column: h5py.Dataset) -> int:
    """Length of a column, once it is known to be a vector of numbers or short strings."""
    if column.ndim != 1:
        raise UserError(f'{path}: column "{name}" must have one dimension, not {column.ndim}')
    text = h5py.check_string_dtype(column.dtype)
    if text is None and column.dtype.kind not in "iufb":
        raise UserError(f'{path}: column "{name}" must hold numbers or strings')
    if text is not None and (text.length or 0) > LARGEST_STRING:
        raise UserError(f'{path}: column "{name}" holds strings longer than {LARGEST_STRING}')
    return column.shape[0]


def _values(column: h5py.Dataset) -> np.ndarray:
    if h5py.check_string_dtype(column.dtype) is None:
        return column[:]
    return np.char.strip(np.array(column.asstr()[:], dtype=str))
