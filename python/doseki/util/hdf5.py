"""HDF5 files of others: nothing outside the file is read, nothing larger than it can hold.

HDF5 lets a file name other files (links, external storage, virtual datasets), claim any size for
data that are not there, and unpack to a thousand times its size.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..errors import UserError
from .foreign import check_regular_file, readable
from .memory import available_bytes

# Deflate, the strongest of the filters allowed, unpacks to at most 1032 times its size.
LARGEST_RATIO = 1032
# Numbers of the HDF5 library; other filters would load code from elsewhere, or unpack to any size.
DEFLATE, SHUFFLE, CHECKSUM, LZF = 1, 2, 3, 32000
MOST_NAMES = 100_000  # of an attribute
LONGEST_TEXT = 2**20  # characters, in an attribute
ALWAYS_HELD = 2**20  # bytes that every machine has


@contextmanager
def open_hdf5(path: Path, content: bytes | None = None) -> Iterator[Hdf5File]:
    """The HDF5 file at `path`, or `content` read from there; raises UserError for anything else."""
    if content is None:
        check_regular_file(path)
    with readable(path, kind="HDF5"):
        source = path if content is None else io.BytesIO(content)
        size = path.stat().st_size if content is None else len(content)
        with h5py.File(source, "r") as file:
            yield Hdf5File(path, file, size)


class Hdf5File:
    """An open HDF5 file, each part of which is looked at before it is read."""

    def __init__(self, path: Path, file: h5py.File, size: int) -> None:
        self.path = path
        self._file, self._size = file, size
        self._groups: dict[str, h5py.Group] = {}  # that have been looked at

    def error(self, name: str, wrong: str) -> UserError:
        """A UserError about the part `name` of this file."""
        return UserError(f'{self.path}: "{name}" {wrong}')

    def names(self, group: str = "/") -> list[str]:
        """What a group holds, in its order."""
        return list(self._part(group, h5py.Group))

    def holds_group(self, name: str) -> bool:
        """Whether there is a group of that name."""
        return name in self and isinstance(self._part(name), h5py.Group)

    def __contains__(self, name: str) -> bool:
        return name in self._file

    def dataset(self, name: str) -> h5py.Dataset:
        """A dataset of numbers or short words that is wholly in this file and fits into memory."""
        dataset = self._part(name, h5py.Dataset)
        if dataset.external or dataset.is_virtual:
            raise self.error(name, "keeps its data in other files, which are not read")
        dtype = dataset.dtype
        if dtype.kind not in "iufb" and h5py.check_string_dtype(dtype) is None:
            raise self.error(name, "must hold numbers or strings")
        self._check_size(name, dataset, dataset.size * dtype.itemsize)
        return dataset

    def numbers(self, name: str) -> np.ndarray:
        """The numbers in a dataset."""
        return self._numbers(name, self.dataset(name))

    def number(self, name: str) -> Any:
        """The only number in a dataset."""
        dataset = self.dataset(name)
        if dataset.size != 1:
            raise self.error(name, f"must hold one number, not {dataset.size}")
        return self._numbers(name, dataset).reshape(1)[0].item()

    def _numbers(self, name: str, dataset: h5py.Dataset) -> np.ndarray:
        if dataset.dtype.kind not in "iufb":
            raise self.error(name, "must hold numbers")
        return dataset[...]

    def words(self, name: str, longest: int) -> np.ndarray:
        """The strings in a vector, none longer than `longest` bytes."""
        dataset = self.dataset(name)
        text = h5py.check_string_dtype(dataset.dtype)
        if text is None or dataset.ndim != 1:
            raise self.error(name, "must hold a vector of strings")
        too_long = self.error(name, f"holds strings longer than {longest}")
        if (text.length or 0) > longest:
            raise too_long
        rows = len(dataset)
        if text.length is None:
            # Any number of rows may share one string as long as the file.
            rows = max(1, available_bytes() // 16 // max(1, self._size))
        parts = [np.zeros(0, "U1")]
        for first in range(0, len(dataset), max(1, rows)):
            found = dataset.asstr()[first : first + rows]
            if max(map(len, found)) > longest:
                raise too_long
            parts.append(np.array(found, dtype=str))
        return np.concatenate(parts)

    def attribute(self, group: str, name: str) -> Any:
        """A number, a text, or a list of names beside a group."""
        attributes = self._part(group).attrs
        if name not in attributes:
            raise self.error(group, f"has no attribute {name}")
        known = attributes.get_id(name)
        count = int(np.prod(known.shape, dtype=float))
        text = h5py.check_string_dtype(known.dtype)
        if text is None and known.dtype.kind not in "iufb":
            raise self.error(name, "must hold numbers or strings")
        # Names of free length may all be one text as long as the file.
        bytes_each = known.dtype.itemsize if text is None or text.length else self._size
        if count > MOST_NAMES or _is_too_large(count * bytes_each):
            raise self.error(name, f"claims {count} entries, more than this machine can hold")
        found = attributes[name]
        return found if text is None else _decoded(found)

    def _part(self, name: str, kind: type = h5py.HLObject) -> Any:
        """A part of the file, to which no link leads elsewhere."""
        part: Any = self._file
        place = ""
        for step in [step for step in name.split("/") if step]:
            place += f"/{step}"
            part = self._groups[place] if place in self._groups else self._step(name, part, step)
            if isinstance(part, h5py.Group):
                self._groups[place] = part
        if not isinstance(part, kind):
            raise self.error(name, f"is not a {kind.__name__.lower()}")
        return part

    def _step(self, name: str, part: Any, step: str) -> Any:
        """One step on the way to `name`."""
        link = part.get(step, getlink=True) if isinstance(part, h5py.Group) else None
        if link is None:
            raise self.error(name, "is missing")
        if not isinstance(link, h5py.HardLink):
            raise self.error(name, "is a link; links are not followed")
        return part[step]

    def _check_size(self, name: str, dataset: h5py.Dataset, claimed: int) -> None:
        """That so many bytes are there, and do not unpack to more than memory holds."""
        stored = dataset.id.get_storage_size()
        if _is_too_large(claimed):
            raise self.error(
                name, f"claims {claimed / 2**30:.3g} GiB, more than this machine can hold"
            )
        if stored > self._size:
            raise self.error(name, "is cut short")
        ratio = 1
        if dataset.chunks is not None:
            ratio = self._check_filters(name, dataset)
            chunk = int(np.prod(dataset.chunks, dtype=float)) * dataset.dtype.itemsize
            if chunk > max(claimed, 2**24):
                raise self.error(name, f"has chunks of {chunk} bytes, more than it has in all")
        if claimed > ratio * stored:
            raise self.error(name, f"claims {claimed} bytes, but the file holds {stored} of it")

    def _check_filters(self, name: str, dataset: h5py.Dataset) -> int:
        """By how much chunks may grow when they are unpacked."""
        plan = dataset.id.get_create_plist()
        filters = [plan.get_filter(k)[0] for k in range(plan.get_nfilters())]
        packing = [number for number in filters if number in (DEFLATE, LZF)]
        if set(filters) - {DEFLATE, SHUFFLE, CHECKSUM, LZF} or len(packing) > 1:
            raise self.error(name, "is packed in a way that is not read; allowed: gzip or lzf")
        if not packing:
            return 1
        largest = [0]
        dataset.id.chunk_iter(lambda found: largest.append(max(largest.pop(), found.size)))
        if LARGEST_RATIO * largest[0] > available_bytes() / 2:
            raise self.error(name, "has chunks that may unpack to more than this machine can hold")
        return LARGEST_RATIO


def _is_too_large(size: int) -> bool:
    """For memory, which is asked each time: what was read before has taken some of it."""
    return size > ALWAYS_HELD and size > available_bytes() / 4


def _decoded(found: Any) -> Any:
    """Texts as str, of free length or of a fixed one."""
    if isinstance(found, np.ndarray):
        return [_decoded(entry) for entry in found.tolist()]
    text = found.decode("utf-8") if isinstance(found, bytes) else str(found)
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"a text of {len(text)} characters")
    return text
