"""A folder of files that is there whole or not at all, and the index of a series in time."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from xml.sax.saxutils import quoteattr

from ..errors import UserError
from ..util.files import clear_errors

Entries = Sequence[tuple[float, str]]  # time, s, and name of a file beside the index


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """The folder to write to, which gets the name `folder` once the block is done.

    `folder` must not exist or be empty, and be no link, or UserError is raised.
    """
    with clear_errors(folder):
        if folder.is_symlink():
            raise UserError(f"{folder}: is a symbolic link; nothing is written through it")
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise UserError(f"{folder}: exists and is not empty; give another folder")
        unfinished = folder.with_name(f".{folder.name}.{os.getpid()}.part")
        unfinished.mkdir(parents=True)
    try:
        yield unfinished
        with clear_errors(folder):
            unfinished.replace(folder)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def pvd(entries: Entries) -> str:
    """A ParaView collection (.pvd) of files, with their times to the last digit."""
    rows = (
        f'<DataSet timestep="{time!r}" part="0" file={quoteattr(name)}/>' for time, name in entries
    )
    return "\n".join(
        (
            '<?xml version="1.0"?>',
            '<VTKFile type="Collection" version="1.0">',
            "<Collection>",
            *rows,
            "</Collection>",
            "</VTKFile>",
            "",
        )
    )


def series(entries: Entries) -> str:
    """A ParaView series (.series) of files of a format that has no time of its own."""
    files = [{"name": name, "time": time} for time, name in entries]
    return json.dumps({"file-series-version": "1.0", "files": files}, indent=1) + "\n"
