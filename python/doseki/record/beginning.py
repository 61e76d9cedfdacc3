"""How the folder of a run begins: whole or not at all, and so that a killed run can be resumed."""

from __future__ import annotations

import errno
from collections.abc import Sequence
from pathlib import Path

from ..errors import UserError
from ..util.files import clear_errors, sync, write_whole, write_whole_text
from ..util.input_file import InputFile
from ..util.sealed import sealed
from .folder import RunFolder
from .lock import holder_of, in_use

TAKEN = {errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR}


def check_free(directory: str | Path, overwrite: bool) -> None:
    """Raise UserError where no run may begin: the folder holds something else, or links."""
    folder = RunFolder(Path(directory))
    with clear_errors(folder.path):
        if _is_free(folder):
            return
        if not overwrite:
            raise _is_taken(folder.path)
        if not folder.is_run():
            raise UserError(f"{folder.path}: is not the folder of a run, so it is not overwritten")
        folder.refuse_links()


def check_vacant(directory: str | Path) -> None:
    """Raise UserError where several runs may not begin: there is something in the folder."""
    folder = RunFolder(Path(directory))
    with clear_errors(folder.path):
        if not _is_free(folder):
            raise UserError(f"{folder.path}: exists and is not empty; give another folder")


def _is_free(folder: RunFolder) -> bool:
    """Whether it is not there yet, or has nothing in it; raises UserError for a file."""
    if folder.path.exists() and not folder.path.is_dir():
        raise UserError(f"{folder.path}: is a file, not a folder")
    return not folder.path.is_dir() or folder.is_vacant()


def begin(folder: RunFolder, scenario: str, inputs: Sequence[InputFile], overwrite: bool) -> None:
    """Put what a run starts from into its folder; an earlier run there makes room.

    A new folder gets its name when all of that is in it.
    """
    check_free(folder.path, overwrite)
    for each in inputs:
        _check_apart(folder, each)
    if folder.path.is_dir():
        _fill(folder, scenario, inputs)
        return
    prepared = RunFolder(folder.path.resolve()).prepared
    with clear_errors(folder.path):
        prepared.path.mkdir(parents=True, exist_ok=True)
        _fill(prepared, scenario, inputs)
        try:
            prepared.path.rename(folder.path)
        except OSError as error:
            raise _is_taken(folder.path) if error.errno in TAKEN else error from None
        sync(folder.path.parent)


def _fill(folder: RunFolder, scenario: str, inputs: Sequence[InputFile]) -> None:
    """The scenario takes the place of an earlier one at once, which goes on until then.

    Before that goes what would go on from the earlier run, after it what was recorded.
    """
    folder.refuse_links()
    with clear_errors(folder.path):
        for file in folder.endings():
            file.unlink()
        folder.snapshots.mkdir(parents=True, exist_ok=True)
        _copy(folder, inputs)
        write_whole_text(folder.scenario, sealed(scenario))
        names = {each.name for each in inputs}
        stale = [file for file in folder.inputs.glob("*") if file.name not in names]
        for file in [*folder.recorded(), *stale]:
            file.unlink(missing_ok=True)


def _check_apart(folder: RunFolder, each: InputFile) -> None:
    """What a run needs must not be in the record that it replaces; copies of inputs may be."""
    here = folder.path.resolve()
    if here in each.path.parents and folder.inputs.resolve() not in each.path.parents:
        raise UserError(
            f"{each.path}: is in the folder that is to be overwritten; give another folder"
        )


def _copy(folder: RunFolder, inputs: Sequence[InputFile]) -> None:
    if inputs:
        folder.inputs.mkdir(exist_ok=True)
    for each in inputs:
        copy = folder.inputs / each.name
        if not (copy.exists() and copy.samefile(each.path)):
            write_whole(copy, each.copy_to)


def _is_taken(path: Path) -> UserError:
    if holder := holder_of(path):
        return in_use(path, holder)
    return UserError(f"{path}: exists and is not empty; give another folder or --overwrite")
