"""Files of others: only ordinary files are opened, and none is read beyond the size that it has."""

from __future__ import annotations

import json
import os
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from ..errors import DosekiError, UserError
from .memory import available_bytes

REMEDY = "bring it back, or move it away"  # of a file that a run has written


@contextmanager
def readable(path: Path, how: str = "", kind: str = "") -> Iterator[None]:
    """Turn whatever reading a damaged, forbidden or hostile file raises into a UserError.

    `kind` is what the file should be, such as "a GeoTIFF", where a library reads it: what that says
    is about its own inside, and is not told.
    """
    try:
        yield
    except (DosekiError, MemoryError):
        raise
    except Exception as error:
        # Readers of damaged files raise almost anything.
        how = how or (kind and f" as {kind}")
        raise UserError(f"{path}: cannot be read{how}: {_cause(error, kind)}") from None


def _cause(error: Exception, kind: str) -> str:
    """Why a file could not be read, in one line."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    if kind:
        return f"it is cut short, damaged, or not {kind}"
    return (str(error) or type(error).__name__).splitlines()[0]


def check_regular_file(path: Path) -> None:
    """Raise UserError unless `path` is a file (not absent, a folder, a pipe or a device)."""
    try:
        if path.is_file():
            return
        kind = "not a regular file" if path.exists() else f"no such file{_looked_in(path)}"
        kind = "a folder, not a file" if path.is_dir() else kind
    except (OSError, ValueError) as error:
        kind = f"cannot be read: {error}"
    raise UserError(f"{path}: {kind}")


def _looked_in(path: Path) -> str:
    """Where a relative path was looked for."""
    return "" if path.is_absolute() else f" in {path.absolute().parent}"


@contextmanager
def open_regular(path: Path) -> Iterator[tuple[BinaryIO, int]]:
    """An ordinary file, open for reading, and its size in bytes; raises UserError for others.

    What the kernel only pretends to be a file (/proc) has no size, and counts as empty.
    """
    check_regular_file(path)
    # Should it have become a pipe since: opening that must not wait for a writer.
    flags = os.O_RDONLY | os.O_NONBLOCK
    with readable(path), os.fdopen(os.open(path, flags), "rb") as file:
        found = os.fstat(file.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise UserError(f"{path}: not a regular file")
        yield file, found.st_size


def read_bytes(path: Path, most: int | None = None) -> bytes:
    """The content of an ordinary file; raises UserError for others and for more than `most` bytes.

    Without `most`, a quarter of the free memory is the limit.
    """
    limit = available_bytes() // 4 if most is None else most
    with open_regular(path) as (file, size):
        if size > limit:
            raise UserError(f"{path}: {size} bytes; at most {limit} are read")
        return file.read(size)


def read_json_table(path: Path, most: int | None = None) -> dict[str, Any]:
    """The table in a JSON file, as a run writes them; raises UserError for anything else."""
    try:
        found = json.loads(read_text(path, most))
    except (ValueError, RecursionError):
        raise UserError(f"{path}: is cut short or damaged: no JSON; {REMEDY}") from None
    if not isinstance(found, dict):
        raise UserError(f"{path}: is damaged: it must hold a table, {{...}}; {REMEDY}")
    return found


def read_toml_table(path: Path, most: int | None = None) -> dict[str, Any]:
    """The same of a TOML file."""
    try:
        return tomllib.loads(read_text(path, most))
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{path}: not valid TOML: {error}") from None
    except (ValueError, RecursionError):
        raise UserError(f"{path}: is damaged: no run writes such TOML; {REMEDY}") from None


def read_text(path: Path, most: int | None = None) -> str:
    """The same for a text in UTF-8."""
    data = read_bytes(path, most)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise UserError(f"{path}, line {line}: not a text file in UTF-8") from None
