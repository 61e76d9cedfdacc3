"""The files that a scenario names: what was read for it, whether its run keeps a copy or not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError
from ..util.input_file import InputFile, input_file
from .values.toml_source import KeyPath, dotted

# Files that programs read with a file, by its ending; the last are added to its whole name.
BESIDE = {
    ".shp": (".shx", ".dbf", ".prj", ".cpg"), ".asc": (".prj",), ".txt": (".prj",),
    ".grd": (".prj",), ".tif": (".tfw",), ".tiff": (".tfw",),
}  # fmt: skip
ADDED = (".aux.xml",)
LARGE = {"terrain", "start"}  # of which the run has copies; their digests are taken when it starts


@dataclass(frozen=True)
class NamedFile:
    """A file, and the key of the scenario for which it was read."""

    key: str
    file: InputFile

    @property
    def table(self) -> dict[str, str]:
        """As provenance.json has it."""
        return {"key": self.key, "file": self.file.path.name, "digest": self.file.digest}


def read_in_full(named: Mapping[KeyPath, Sequence[Path]]) -> list[InputFile]:
    """Files with the content that they have now, but for those that are large and are copied."""
    return [
        each
        for keys, paths in named.items()
        if keys[0] not in LARGE
        for path in paths
        for each in _with_those_beside(path, {})
    ]


def named_files(
    named: Mapping[KeyPath, Sequence[Path]], known: Mapping[Path, InputFile]
) -> list[NamedFile]:
    """All files by key; `known` are those that were looked at before, by their places."""
    return [
        NamedFile(dotted(keys), each)
        for keys, paths in named.items()
        for path in paths
        for each in _with_those_beside(path, known)
    ]


def _with_those_beside(path: Path, known: Mapping[Path, InputFile]) -> Iterator[InputFile]:
    """A file and those that belong to it, as far as they are there and can be read.

    Raises UserError where the file itself cannot.
    """
    yield known.get(path.resolve()) or input_file(path)
    endings = BESIDE.get(path.suffix.lower(), ())
    beside = [path.with_suffix(ending) for ending in endings]
    beside += [path.with_name(path.name + ending) for ending in ADDED if endings]
    for each in beside:
        if each.is_file():
            with suppress(UserError):
                yield known.get(each.resolve()) or input_file(each)
