"""A scenario file as text and table: reading, `extends`, and where in the text a key stands."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from ...errors import UserError
from ...util.foreign import read_text

MAX_BYTES = 16 * 2**20
MAX_DEPTH = 32
DEEP = f"tables or lists nested more than {MAX_DEPTH} deep"
# How what Python says of a key begins that is there before.
GIVEN_TWICE = ("Cannot overwrite", "Cannot declare", "Cannot mutate", "Cannot redefine")
KeyPath = tuple[str | int, ...]


@dataclass(frozen=True)
class TableSource:
    """A table that was made in Python; files that it names are relative to `folder`."""

    folder: Path
    table: dict[str, Any]

    @property
    def name(self) -> str:
        """What messages call it."""
        return "scenario"

    def line_of(self, keys: KeyPath) -> int | None:
        """There are no lines."""
        return None


@dataclass(frozen=True)
class TomlSource:
    """The text of one TOML file and the table it holds."""

    path: Path
    text: str
    table: dict[str, Any]

    @property
    def name(self) -> str:
        """What messages call it."""
        return str(self.path)

    @property
    def folder(self) -> Path:
        """To what files that it names are relative."""
        return self.path.parent

    def line_of(self, keys: KeyPath) -> int | None:
        """The line (from 1) where `keys` is set, or the nearest table that would hold it."""
        wanted = [str(key) for key in keys]
        best_line, best_depth = None, 0
        for number, here, _ in self._named():
            if len(here) > best_depth and here == wanted[: len(here)]:
                best_line, best_depth = number, len(here)
        return best_line

    def assigns(self, keys: KeyPath) -> bool:
        """Whether a line gives `keys` a value, rather than some of what would be in it."""
        wanted = dotted(keys).split(".")
        return any(is_value and here == wanted for _, here, is_value in self._named())

    def _named(self) -> Iterator[tuple[int, list[str], bool]]:
        """Each line that names keys: its number, their full path, and whether it gives a value."""
        header: list[str] = []
        for number, line in enumerate(self.text.splitlines(), start=1):
            here = _keys_of_line(line, header)
            if here is None:
                continue
            is_header = line.lstrip().startswith("[")
            if is_header:
                header = here
            yield number, here, not is_header


Source: TypeAlias = TableSource | TomlSource


def _keys_of_line(line: str, header: list[str]) -> list[str] | None:
    """The full key path that a header `[a.b]`, or `[[a.b]]`, or an assignment `a.b = ...` names."""
    key = r"[\w-]+|\"[^\"]*\""
    path = rf"((?:{key})(?:\s*\.\s*(?:{key}))*)"
    if found := re.match(rf"\s*\[{{1,2}}\s*{path}\s*\]", line):
        return _split(found[1])
    if found := re.match(rf"\s*{path}\s*=", line):
        return header + _split(found[1])
    return None


def _split(path: str) -> list[str]:
    return [part.strip().strip('"') for part in path.split(".")]


def read_toml(path: Path) -> TomlSource:
    """Read one TOML file; raises UserError for anything that is not readable TOML."""
    text = read_text(path, MAX_BYTES).removeprefix("\ufeff")  # which some editors put first
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise UserError(_said(path, text, str(error))) from None
    except RecursionError:
        raise UserError(f"{path}: {DEEP}") from None
    except ValueError:  # all that is no mistake of TOML: more digits than Python reads
        raise UserError(_said_of_digits(path, text)) from None
    if is_deep(table):
        raise UserError(f"{path}: {DEEP}")
    return TomlSource(path, text, table)


def _said(path: Path, text: str, message: str) -> str:
    """What is wrong with a text that is not TOML; of a key that is there twice, which and where."""
    found = re.search(r"at line (\d+)", message)
    lines = int(found[1]) if found else text.count("\n") + 1
    named = TomlSource(path, text, {})._named()
    before = [each for each in named if each[0] <= lines]
    if not message.startswith(GIVEN_TWICE) or not before:
        return f"{path}: not valid TOML: {message}"
    line, keys, _ = before.pop()
    same = [(n, k) for n, k, _ in reversed(before) if k[: len(keys)] == keys[: len(k)]]
    name = ".".join(keys)
    if not same:
        return f"{path}, line {line}: {name} is given twice; give it once"
    first, other = next((each for each in same if each[1] == keys), same[0])
    if other == keys:
        return f"{path}, line {line}: {name} is given twice, at first in line {first}; give it once"
    return (
        f"{path}, line {line}: {name} does not go with {'.'.join(other)} in line {first}; give one"
    )


def _said_of_digits(path: Path, text: str) -> str:
    """What is wrong with a text in which a number has more digits than can be read."""
    most = sys.get_int_max_str_digits()
    found = re.search(rf"[0-9_]{{{most},}}", text)
    place = f", line {text[: found.start()].count(chr(10)) + 1}" if found else ""
    return f"{path}{place}: a whole number of more than {most} digits; write it as 1e12 is written"


def is_deep(table: dict[str, Any]) -> bool:
    """Whether the nesting would exhaust functions that call themselves."""
    level: list[Any] = [table]
    for _ in range(MAX_DEPTH):
        inside = [part.values() if isinstance(part, dict) else part for part in level]
        level = [entry for part in inside for entry in part if isinstance(entry, dict | list)]
    return bool(level)


@dataclass(frozen=True)
class Change:
    """A value that takes the place of what a scenario has at a key.

    Of a table, its keys are taken over one by one; with `may_add` it may be one that is not there.
    """

    key: str  # as the user names it
    value: Any  # what TOML can hold
    said: str  # how messages name it: --set dp
    folder: Path = Path()  # to which files that it names are relative
    may_add: bool = False


class Where:
    """Names the place of a key for an error message: file and line, or the --set option."""

    def __init__(self, sources: Sequence[Source]) -> None:
        self._sources = sources  # the scenario first, then the files it extends
        self._changes: dict[KeyPath, Change] = {}
        self._written: dict[KeyPath, KeyPath] = {}
        self._files: dict[KeyPath, Path] = {}
        self._named: dict[KeyPath, list[Path]] = {}

    @property
    def files(self) -> Mapping[KeyPath, Path]:
        """The keys at which files were looked for, as written, and to what these are relative."""
        return self._files

    def folder(self, keys: KeyPath) -> Path:
        """To what a file name given at `keys` is relative: that file, or here for an option."""
        keys = self._as_written(keys)
        change = self._change(keys)
        folder = self._deepest(keys).folder if change is None else change.folder
        self._files[keys] = folder
        return folder

    @property
    def named(self) -> Mapping[KeyPath, Sequence[Path]]:
        """The files read for each key, as written; the scenario and its bases among them."""
        files = [source.path for source in self._sources if isinstance(source, TomlSource)]
        keys: list[KeyPath] = [("extends",)] * len(files)
        if isinstance(self._sources[0], TomlSource):
            keys[0] = ("scenario",)
        read: dict[KeyPath, list[Path]] = {}
        for key, file in zip(keys, files, strict=True):
            read.setdefault(key, []).append(file)
        return read | self._named

    def file(self, keys: KeyPath, name: str) -> Path:
        """The file that is named at `keys`, and will be read."""
        path = self.folder(keys) / name
        paths = self._named.setdefault(self._as_written(keys), [])
        if path not in paths:
            paths.append(path)
        return path

    def note_change(self, keys: KeyPath, change: Change) -> None:
        """Remember that a change gave what stands at these keys."""
        self._changes[keys] = change

    def note_copy(self, keys: KeyPath, written: KeyPath) -> None:
        """Remember that the table at `keys` was made of the one that stands at `written`."""
        self._written[keys] = written

    def error(self, keys: KeyPath, message: str) -> UserError:
        """A UserError about `keys`, which names the file and line, or the option, to look at.

        What disagrees with other keys of its table may be said of the table, or of one of them:
        where options gave some, the one that the message names first is that to look at.
        """
        written = self._as_written(keys)
        table = written[:-1] if written[1:] and not self._is_table(written) else written
        change = self._change(written) or self._change_inside(table, message)
        return UserError(f"{self._place(written) if change is None else change.said}: {message}")

    def _as_written(self, keys: KeyPath) -> KeyPath:
        """Where the file has the value at `keys`."""
        written = self._written.get(keys[:2])
        return keys if written is None else (*written, *keys[2:])

    def _place(self, keys: KeyPath) -> str:
        if change := self._change(keys):
            return change.said
        source = self._deepest(keys)
        line = source.line_of(keys)
        return f"{source.name}, line {line}" if line else source.name

    def _change(self, keys: KeyPath) -> Change | None:
        """The change that gave `keys`, or a table they are in."""
        prefixes = (keys[:length] for length in range(len(keys), 0, -1))
        return next((self._changes[p] for p in prefixes if p in self._changes), None)

    def _change_inside(self, table: KeyPath, text: str) -> Change | None:
        """The change of a key in the table that a text about it names first."""
        found = {}
        sentence = text.removeprefix(dotted(table)).split(" (")[0]  # without what keys mean
        for keys, change in self._changes.items():
            named = re.search(rf"(?<![\w/-]){re.escape(str(keys[-1]))}(?![\w/-])", sentence)
            if named and table and keys[: len(table)] == table:
                found[named.start()] = change
        return found[min(found)] if found else None

    def _is_table(self, keys: KeyPath) -> bool:
        table: Any = self._deepest(keys).table
        for key in keys:
            table = table.get(key) if isinstance(table, dict) else None
        return isinstance(table, dict)

    def _deepest(self, keys: KeyPath) -> Source:
        """The source that holds the most of `keys`, an extending file before what it extends."""
        return max(self._sources, key=lambda source: _depth(source.table, keys))


def _depth(table: Any, keys: KeyPath) -> int:
    """How many of `keys` can be followed into `table`."""
    for depth, key in enumerate(keys):
        if not isinstance(table, dict) or key not in table:
            return depth
        table = table[key]
    return len(keys)


def dotted(keys: KeyPath) -> str:
    """The key path as a user writes it: body.left.velocity."""
    return ".".join(str(key) for key in keys)
