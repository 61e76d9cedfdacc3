"""Writing files safely: whole or not at all, and one clear sentence when the disk refuses."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import ResourceError, UserError

_OUT_OF_SPACE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


@contextmanager
def clear_errors(path: Path) -> Iterator[None]:
    """Turn a failed write to `path` into a ResourceError (disk full) or a UserError."""
    try:
        yield
    except OSError as error:
        kind = ResourceError if error.errno in _OUT_OF_SPACE else UserError
        raise kind(f"{path}: cannot be written: {error.strerror or error}") from None


def write_whole(path: Path, write: Callable[[Path], object], safely: bool = True) -> None:
    """Let `write` make a temporary file, put it safely on the disk, then give it its name.

    Readers, and a run that is killed, never see half a file. Not `safely`, it takes a few
    milliseconds less, and may be gone when the machine goes down.
    """
    temporary = path.with_name(f".{path.name}.part")
    with clear_errors(path):
        try:
            write(temporary)
            if safely:
                sync(temporary)
            temporary.replace(path)
            if safely:
                sync(path.parent)
        finally:
            temporary.unlink(missing_ok=True)


def write_whole_text(path: Path, text: str, safely: bool = True) -> None:
    """The same for a text in UTF-8."""
    write_whole(path, lambda temporary: temporary.write_text(text, encoding="utf-8"), safely)


def sync(path: Path) -> None:
    """Wait until a file, or the names in a folder, are safely on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def free_directory(name: str) -> Path:
    """runs/NAME, or runs/NAME-2, -3 ... where that is taken."""
    base = Path("runs") / Path(name).stem
    candidates = [base, *(base.with_name(f"{base.name}-{k}") for k in range(2, 10000))]
    return next(path for path in candidates if not path.exists())
