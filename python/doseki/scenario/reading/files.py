"""The files behind a scenario: shipped ones by name, others by path, and what they extend."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...errors import UserError
from ...util.foreign import check_regular_file
from ...util.spelling import suggestion
from ..tables.sections import ALIASES, EXCLUSIVE
from ..values.toml_source import Source, TomlSource, Where, read_toml


def scenario_folder() -> Path:
    """Folder of the shipped scenarios: beside this module when installed, else in the tree."""
    here = Path(__file__).resolve().parents[2]  # the package
    installed = here / "scenarios"
    return installed if installed.is_dir() else here.parents[1] / "scenarios"


def find_scenario(name: str) -> Path:
    """A bare name means a shipped scenario; with a "/" or the ending .toml it is a path.

    Raises UserError for a name that is none, and for a folder.
    """
    if "/" in name and Path(name).is_dir():
        raise UserError(
            f"{name}: a folder; what is asked for is a scenario{_scenario_of_run(name)}"
        )
    if "/" in name or name.endswith(".toml"):
        return Path(name)
    shipped = {path.stem: path for path in scenario_folder().glob("*.toml")}
    if name not in shipped:
        raise UserError(f'no scenario named "{name}"{suggestion(name, shipped)}')
    return shipped[name]


def _scenario_of_run(folder: str) -> str:
    """Where a folder is that of a run, what it has of it."""
    copy = Path(folder) / "scenario.toml"
    if not copy.is_file():
        return ", a TOML file or the name of a shipped one"
    return f": that of this run is {copy}; what came of the run is in its summary.txt"


def read_with_bases(first: Source) -> list[Source]:
    """The scenario, then the file it extends, and so on."""
    sources, files = [first], [first.path] if isinstance(first, TomlSource) else []
    while (base := sources[-1].table.get("extends")) is not None:
        last = sources[-1]
        if not isinstance(base, str):
            name = last.name
            raise UserError(f"{name}: extends = {base!r} must be the name or path of a scenario")
        source = read_toml(_extended(last, base))
        if any(source.path.samefile(known) for known in files):
            raise UserError(f'{last.name}: extends = "{base}" leads back to the file itself')
        sources.append(source)
        files.append(source.path)
    return sources


def _extended(source: Source, base: str) -> Path:
    """The file that a source extends; raises UserError, which names both, where it is not there."""
    try:
        path = source.folder / find_scenario(base)
        check_regular_file(path)
    except UserError as error:
        raise UserError(f'{source.name}: extends = "{base}": {error}') from None
    return path


def merged_table(sources: Sequence[Source], where: Where) -> dict[str, Any]:
    """The tables of the sources laid over one another, the first on top."""
    table: dict[str, Any] = {}
    for source in reversed(sources):
        table = _laid_over(table, _canonical(source, where))
    return table


def _canonical(source: Source, where: Where) -> dict[str, Any]:
    """The file's table with aliases replaced by the names they stand for."""
    table = {key: value for key, value in source.table.items() if key != "extends"}
    for alias, key in ALIASES.items():
        if alias in table and key in table:
            raise where.error((alias,), f"{alias} and {key} are the same thing: give one")
        if alias in table:
            table[key] = table.pop(alias)
    return table


def _laid_over(base: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    """`top` merged into `base`, table by table; a key of `top` also displaces its rivals."""
    rivals = {rival for pair in EXCLUSIVE if set(pair) & set(top) for rival in pair}
    merged = {key: value for key, value in base.items() if key not in rivals}
    for key, value in top.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = _laid_over(merged[key], value) if both else value
    return merged
