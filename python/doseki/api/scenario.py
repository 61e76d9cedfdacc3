"""Scenarios in Python: made, read, changed and written, by the reading that files go through."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import UserError
from ..scenario.load import checked_scenario
from ..scenario.model import Scenario as CheckedScenario
from ..scenario.reading.changes import Gone, place_of, with_changes
from ..scenario.reading.files import find_scenario, merged_table, read_with_bases
from ..scenario.reading.python_values import plain_table, plain_value
from ..scenario.values.expressions import is_expression
from ..scenario.values.toml_source import Change, Source, TableSource, Where, dotted, read_toml
from ..util.files import write_whole_text
from ..util.spelling import suggestion
from ..util.toml_writer import to_toml
from .arguments import path_of, thread_count

if TYPE_CHECKING:
    from ..assess.preflight import Preflight

KEY = "a key must be a word, such as material.water.rho0"
FRESH = "scenario"  # the name of one that no file has


class Scenario(Mapping[str, Any]):
    """A run, described and checked: what a scenario file holds.

    It is made of a shipped scenario by its name, of a TOML file by its path, or of tables as a
    file has them, with expressions, units, `[parameters]` and `extends`:

        doseki.Scenario("flume")
        doseki.Scenario("my/case.toml", dp=0.005)
        doseki.Scenario(dim=2, dp=0.01, time_max=1, time_out=0.1, body={"water": {...}})

    With a name, a path or a dictionary the keywords are changes, as `changed` makes them.  Values
    may be numbers, words, lists, tables, and numpy's numbers and arrays, tuples and paths.  Files
    that it names are relative to the scenario file, or to the working directory where they are
    named in Python.

    It is a mapping of checked values, every expression worked out: `scenario["dp"]`, m,
    `scenario["body"]["water"]["min"]`, a list, `scenario["material.water.rho0"]`, kg/m3, and the
    value of a parameter by its name.  It never changes: `changed` and `without` make another one.

    Raises UserError with one sentence (key, value, what is allowed) for what is not right.
    """

    def __init__(
        self,
        source: str | os.PathLike[str] | Mapping[str, Any] | None = None,
        /,
        **keywords: Any,
    ) -> None:
        """`source`: name, path or tables; without it the keywords are the tables."""
        self._sources: tuple[Source, ...]
        self._changes: tuple[Change, ...]
        self._name: str
        if source is None and keywords:
            source, keywords = keywords, {}
        if isinstance(source, Scenario):
            self._sources, self._name = source._sources, source._name
            self._changes = (*source._changes, *changes_of(keywords))
        else:
            first, self._name = _first_source(source)
            self._sources = tuple(read_with_bases(first))
            self._changes = changes_of(keywords)
        self._checked = checked_scenario(self._sources, self._changes)

    @classmethod
    def _of(cls, sources: Sequence[Source], changes: Sequence[Change], name: str) -> Scenario:
        made = cls.__new__(cls)
        made._sources, made._changes, made._name = tuple(sources), tuple(changes), name
        made._checked = checked_scenario(made._sources, made._changes)
        return made

    def __setattr__(self, name: str, value: Any) -> None:
        """Only what begins with an underscore is set, by the scenario itself."""
        if not name.startswith("_"):
            raise AttributeError(
                f"a scenario never changes, so {name} cannot be set; changed({name}={value!r}) "
                "makes another one"
            )
        super().__setattr__(name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        return Scenario._of, (self._sources, self._changes, self._name)

    @property
    def name(self) -> str:
        """Of the shipped scenario or the file that it comes from, else "scenario"."""
        return self._name

    @property
    def checked(self) -> CheckedScenario:
        """What the solver is given."""
        return self._checked

    def changed(self, changes: Mapping[str, Any] | None = None, /, **keywords: Any) -> Scenario:
        """Another scenario with other values, as `--set KEY=VALUE` of the command line has them.

        A key is one of the top level, the name of a parameter, or a path such as
        "material.water.rho0"; expressions that depend on it give other values, too.  A table is
        laid over the one of its name, or is new: `changed(gauge={"toe": {...}})`,
        `changed({"body.weir": {...}})`.  Changes are made in their order and checked together.
        Raises UserError for a key that the scenario cannot have, and for what no longer fits.
        """
        made = (*changes_of(changes), *changes_of(keywords))
        return Scenario._of(self._sources, (*self._changes, *made), self._name)

    def without(self, *keys: str) -> Scenario:
        """Another scenario that does not have these keys or tables: `without("body.weir")`.

        Raises UserError for a key that it does not give, and for what no longer fits.
        """
        for key in keys:
            if not isinstance(key, str):
                raise UserError(f"without({key!r}): {KEY}")
        gone = [Change(key, Gone.GONE, f"without({key})") for key in keys]
        return Scenario._of(self._sources, (*self._changes, *gone), self._name)

    def check(self, threads: int | None = None) -> Preflight:
        """What the run will take and what is doubtful about it, after a second of stepping.

        The answer has `warnings`, a sentence each, `particles`, `steps`, `seconds` of wall time,
        `timestep`, s, `memory` and `disk`, bytes; printed, it is the report of `doseki check`.
        Raises UserError, PhysicsError or ResourceError for what cannot start.
        """
        from ..assess.preflight import preflight

        return preflight(self._checked, thread_count(threads))

    def to_toml(self, evaluated: bool = False) -> str:
        """The scenario as a TOML file, in one piece, with files named by their whole paths.

        Expressions and parameters stay as they were written, so that they can be changed;
        `evaluated`, it has the numbers that they give.
        """
        return self._checked.effective_toml() if evaluated else to_toml(self._movable_table())

    def save(self, path: str | os.PathLike[str], evaluated: bool = False) -> Path:
        """Write `to_toml()` into a file that `doseki run` and `Scenario(path)` read.

        A file that is there is replaced.  Raises UserError where it cannot be written.
        """
        path = path_of(path, "path")
        write_whole_text(path, self.to_toml(evaluated))
        return path

    def __getitem__(self, key: str) -> Any:
        """The value of a key, or a table: a copy."""
        if not isinstance(key, str):
            raise KeyError(f"the scenario has no {key!r}: {KEY}")
        path = place_of(key, self._values)
        found: Any = self._values
        for step in path:
            if not isinstance(found, dict) or step not in found:
                near = suggestion(str(step), found) if isinstance(found, dict) else ""
                raise KeyError(f"the scenario has no {key}{near}")
            found = found[step]
        of_parameter = path[0] == "parameters" and key == path[-1]
        return found["value"] if of_parameter and len(path) == 2 else copy.deepcopy(found)

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        title = f" {self._checked.title!r}" if self._checked.title else ""
        of = self._checked
        return (
            f"<doseki.Scenario {self._name}:{title} {of.dim}-D, {of.scheme}, dp = {of.dp:g} m,"
            f" {of.time_max:g} s, bodies: {', '.join(of.body) or 'none'}>"
        )

    @cached_property
    def _values(self) -> dict[str, Any]:
        return self._checked.values()

    def _movable_table(self) -> dict[str, Any]:
        """The table as it was written, but for paths: they hold wherever it is read."""
        where = Where(self._sources)
        table = with_changes(merged_table(self._sources, where), self._changes, where)
        _ = self._checked.body_files  # their places are known once they were looked for
        for keys, folder in self._checked.where.files.items():
            *above, last = keys
            holder: Any = table
            for key in above:
                holder = holder.get(key, {})
            if last in holder:
                holder[last] = _absolute(holder[last], folder, dotted(keys))
        return table


def _first_source(source: object) -> tuple[Source, str]:
    """What is read first, and how the scenario is called."""
    if isinstance(source, Mapping):
        return TableSource(Path.cwd(), plain_table(source, FRESH)), FRESH
    if isinstance(source, str):
        path = find_scenario(source)
    elif isinstance(source, os.PathLike):
        path = Path(os.fsdecode(source))
    else:
        kind = type(source).__name__
        raise UserError(f"a scenario is a name, a path or a dictionary of tables, not a {kind}")
    return read_toml(path.absolute()), path.stem


def changes_of(values: Mapping[str, Any] | None) -> tuple[Change, ...]:
    """Values by key as changes of a scenario; raises UserError for what is no value."""
    here, found = Path.cwd(), []
    if values is None:
        return ()
    if not isinstance(values, Mapping):
        raise UserError(f"changes = {values!r}; allowed: a dictionary of values by their keys")
    for key, value in values.items():
        if not isinstance(key, str):
            raise UserError(f"changed({key!r}): {KEY}")
        said = f"changed({key})"
        found.append(Change(key, plain_value(value, key, said), said, here, may_add=True))
    return tuple(found)


def _absolute(value: Any, folder: Path, name: str) -> Any:
    """A path, or each of several, so that it holds anywhere; what is no path as it is."""
    if isinstance(value, dict):
        return {key: _absolute(inner, folder, name) for key, inner in value.items()}
    if isinstance(value, list):
        return [_absolute(inner, folder, name) for inner in value]
    if not isinstance(value, str):
        return value
    if is_expression(value):
        raise UserError(f"to_toml: {name} is an expression; to_toml(evaluated=True) has its value")
    return str((folder / value).absolute())
