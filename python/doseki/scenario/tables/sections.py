"""Which table stands where in a scenario file, for messages and options."""

from __future__ import annotations

from typing import Any, get_args, get_origin

from ..table import Kinds, Part, Table
from .root import ScenarioTable

TOP_LEVEL_KEYS = {field.alias or name for name, field in ScenarioTable.model_fields.items()}
ALIASES = {"hdp": "eta"}  # names people already type
EXCLUSIVE = (
    ("gravity", "slope"),
    ("xi", "xi_height"),
    ("xi", "speed_max"),
    ("xi_height", "speed_max"),
)
RIVALS = {  # keys of a table of which only one is given: --set puts one in the other's place
    "body": (("d", "grading"), ("count", "mass_total")),
    "figure": (("times", "when"),),
    "inflow": (
        ("rate", "hydrograph"),
        ("duration", "hydrograph"),
        *((key, "surge") for key in ("rate", "hydrograph", "duration", "depth")),
    ),
}


def _kind_of_entries(annotation: Any) -> type[Table] | Kinds:
    """What the tables of a section are, from its annotation `dict[str, ...]`."""
    _, entries = get_args(annotation)
    found = [about for about in get_args(entries) if isinstance(about, Kinds)]
    return found[0] if found else entries


# Tables by name: of one kind each, or of several.
SECTIONS: dict[str, type[Table] | Kinds] = {
    name: _kind_of_entries(field.annotation)
    for name, field in ScenarioTable.model_fields.items()
    if get_origin(field.annotation) is dict
}


def _single_table(annotation: Any) -> type[Table] | None:
    """The table that a key holds, or may hold."""
    kinds = [annotation, *get_args(annotation)]
    return next((k for k in kinds if isinstance(k, type) and issubclass(k, Table)), None)


SINGLE_TABLES: dict[str, type[Table]] = {  # of which a scenario has one
    name: kind
    for name, field in ScenarioTable.model_fields.items()
    if get_origin(field.annotation) is not dict and (kind := _single_table(field.annotation))
}


def can_be_switched_off(section: str) -> bool:
    """Whether the tables of a section have the key `enabled`."""
    kind = SECTIONS.get(section)
    return issubclass(kind.common if isinstance(kind, Kinds) else kind or Table, Part)


def table_at(keys: tuple[str | int, ...], table: Any) -> type[Table] | None:
    """The kind of table that stands at `keys` (top level: empty) of the scenario `table`."""
    if not keys:
        return ScenarioTable
    section = str(keys[0])
    if len(keys) == 1:
        return SINGLE_TABLES.get(section)
    kind = SECTIONS.get(section)
    if isinstance(kind, Kinds):
        kind = kind.of(_at(keys[:2], table))
    if len(keys) == 2 or kind is None:
        return kind
    return _inner_table(kind, str(keys[2])) if len(keys) == 3 else None


def _at(keys: tuple[str | int, ...], table: Any) -> Any:
    for key in keys:
        table = table.get(key) if isinstance(table, dict) else None
    return table


def _inner_table(kind: type[Table], key: str) -> type[Table] | None:
    """The table that a key of a table of this kind holds."""
    field = kind.model_fields.get(key)
    inner = get_args(field.annotation) if field is not None else ()
    return next((t for t in inner if isinstance(t, type) and issubclass(t, Table)), None)
