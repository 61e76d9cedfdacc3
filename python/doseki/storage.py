"""Writing files safely: whole or not at all, and one clear sentence when the disk refuses."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import ResourceError, UserError

_OUT_OF_SPACE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


@contextmanager
def clear_errors(path: Path) -> Iterator[None]:
    """Turn a failed write to `path` into a ResourceError (disk full) or a UserError."""
    try:
        yield
    except (OSError, RuntimeError) as error:  # HDF5 reports some failed writes as RuntimeError
        code = _error_number(error)
        if code is None:
            raise
        if code in _OUT_OF_SPACE:
            raise ResourceError(f"{path}: cannot be written: {os.strerror(code)}") from None
        raise UserError(f"{path}: cannot be written: {os.strerror(code)}") from None


def _error_number(error: Exception) -> int | None:
    if getattr(error, "errno", None):
        return error.errno
    found = re.search(r"errno = (\d+)", str(error))
    return int(found[1]) if found else None


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` make a temporary file, put it safely on the disk, then give it its name.

    Readers, and a run that is killed, never see half a file.
    """
    temporary = path.with_name(f".{path.name}.part")
    with clear_errors(path):
        try:
            write(temporary)
            _sync(temporary)
            temporary.replace(path)
            _sync(path.parent)
        finally:
            temporary.unlink(missing_ok=True)


def write_whole_text(path: Path, text: str) -> None:
    """The same for a text in UTF-8."""
    write_whole(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
