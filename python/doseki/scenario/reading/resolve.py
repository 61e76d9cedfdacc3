"""From the table a file holds to plain values: parameters, expressions, choices."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from keyword import iskeyword
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import ValidationError, create_model

from ..schemes import RESOLVED, UETA2022
from ..table import Kinds, Table, limited_keys
from ..tables.parameter import Parameter
from ..tables.root import ScenarioTable
from ..tables.sections import (
    EXCLUSIVE,
    SECTIONS,
    SINGLE_TABLES,
    TOP_LEVEL_KEYS,
    can_be_switched_off,
    table_at,
)
from ..values.expressions import (
    CONSTANTS,
    POSITION_NAMES,
    RESERVED_NAMES,
    ExpressionError,
    evaluate,
    is_expression,
    names_in,
)
from ..values.toml_source import KeyPath, Where, dotted
from .messages import to_user_error

# A value may be a choice by the number of dimensions or by the scheme.
CHOICES = {"dim": {"d2", "d3"}, "scheme": {UETA2022, RESOLVED}}
ABSENT = object()  # the value of a key in a run that has no such key
WORDS = {"schema", "title", "description"}  # top-level keys that no expression needs
# Of a body: may use x, y, z.
SPATIAL_KEYS = ("velocity", "pressure", "where", "clamped", "displacement")


def resolve_table(table: dict[str, Any], where: Where) -> tuple[dict[str, Any], dict[str, Any]]:
    """The table with every expression evaluated, and the names expressions may use.

    Parts with `enabled = false` are left out; what of a body depends on x, y, z stays an
    expression.  Raises UserError.
    """
    _check_names(table, where)
    names = Names(table, where)
    kept = {key: _enabled(section, key, names) for key, section in table.items()}
    resolved = {key: names.resolve(value, (key,)) for key, value in kept.items()}
    resolved = {key: value for key, value in resolved.items() if value is not ABSENT}
    if isinstance(resolved.get("parameters"), dict):
        resolved["parameters"] = {name: names.parameter(name) for name in resolved["parameters"]}
    return resolved, {name: names[name] for name in names}


def _check_names(table: dict[str, Any], where: Where) -> None:
    for pair in EXCLUSIVE:
        if all(key in table for key in pair):
            raise where.error(pair[:1], f"{pair[0]} and {pair[1]} exclude each other: give one")
    for name in _dict(table.get("parameters")):
        if meaning := _meaning_of(name):
            message = f"parameters.{name}: the name has another meaning, {meaning}; choose another"
            raise where.error(("parameters", name), message)


def _meaning_of(name: str) -> str:
    """What a name means that no parameter may have; "" of one that is free."""
    if name in {*SECTIONS, *SINGLE_TABLES}:
        return f"the table [{name}]"
    if name in TOP_LEVEL_KEYS:
        fields = ScenarioTable.model_fields
        about = next((f.description for k, f in fields.items() if (f.alias or k) == name), None)
        return f"the key {name} of a scenario" + (f" ({about})" if about else "")
    if name in POSITION_NAMES:
        return "a coordinate in expressions"
    if name in RESERVED_NAMES:
        return "a constant in expressions" if name in CONSTANTS else "a function in expressions"
    return "a word of the language of expressions" if iskeyword(name) else ""


def _enabled(section: Any, key: str, names: Names) -> Any:
    """The section without the parts that are switched off."""
    if not can_be_switched_off(key) or not isinstance(section, dict):
        return section
    return {
        name: part
        for name, part in section.items()
        if names.resolve(_dict(part).get("enabled", True), (key, name, "enabled")) is not False
    }


def _dict(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


class Names(Mapping[str, Any]):
    """Names for expressions: parameters and top-level values, each evaluated when first needed."""

    def __init__(self, table: dict[str, Any], where: Where) -> None:
        self._where = where
        self._table = table
        self._parameters = _dict(table.get("parameters"))
        self._top_level = _defaults() | _scalars(table)
        self._values: dict[str, Any] = {}
        self._waiting: list[str] = []
        self._scheme = self._top_level.get("scheme", UETA2022)
        self._dim = self._checked_dim()

    def __iter__(self) -> Iterator[str]:
        return iter([*self._top_level, *self._parameters])

    def __len__(self) -> int:
        return len(self._top_level) + len(self._parameters)

    def __getitem__(self, name: str) -> Any:
        if name not in self._values:
            if name not in self._parameters and name not in self._top_level:
                raise KeyError(name)
            self._values[name] = self._evaluate_once(name)
        return self._values[name]

    def parameter(self, name: str) -> dict[str, Any]:
        """The table of a parameter with its value evaluated."""
        return _parameter_table(self._parameters[name]) | {"value": self[name]}

    def resolve(self, value: Any, keys: KeyPath) -> Any:
        """`value`, which stands at `keys`, with expressions evaluated and choices made."""
        if isinstance(value, dict):
            if (by := chooses(value)) is not None:
                return self.resolve(self._chosen(value, by, keys), keys)
            found = {key: self.resolve(inner, (*keys, key)) for key, inner in value.items()}
            return {key: inner for key, inner in found.items() if inner is not ABSENT}
        if isinstance(value, list):
            return [self.resolve(inner, (*keys, index)) for index, inner in enumerate(value)]
        return self._value_of(value, keys) if is_expression(value) else value

    def _value_of(self, text: str, keys: KeyPath) -> Any:
        try:
            in_space = names_in(text) & set(POSITION_NAMES)
            if in_space and keys[0] == "body" and keys[2:3] and keys[2] in SPATIAL_KEYS:
                return text
            return evaluate(text, self)
        except ExpressionError as error:
            raise self._where.error(keys, f"{dotted(keys)}: {error}") from None

    def _chosen(self, choice: dict[str, Any], by: str, keys: KeyPath) -> Any:
        """The value for the dimension or the scheme of this run."""
        if by in self._waiting:
            raise self._where.error((by,), f"{by} must not depend on itself")
        key = f"d{self._dim}" if by == "dim" else self._scheme
        if key not in choice:
            if self._means_nothing(keys):
                return ABSENT
            run = f"a {self._dim}-D run" if by == "dim" else f"the scheme {self._scheme}"
            message = f"{dotted(keys)} has no value for {run} ({key} is missing)"
            raise self._where.error(keys, message)
        return choice[key]

    def _means_nothing(self, keys: KeyPath) -> bool:
        """Whether this run has no such key, so that a choice needs not name a value for it."""
        table = self._with_kind_of_part(keys)
        for depth, key in enumerate(keys):
            kind = table_at(keys[:depth], table)
            only = dict(limited_keys(kind)).get(str(key)) if kind is not None else None
            if only is not None and not only.allows(self._scheme, self._dim):
                return True
        return False

    def _with_kind_of_part(self, keys: KeyPath) -> dict[str, Any]:
        """The table, in which the part that `keys` lead to names its kind without a choice."""
        kinds = SECTIONS.get(str(keys[0]))
        if len(keys) < 3 or not isinstance(kinds, Kinds):
            return self._table
        section, name, word = str(keys[0]), str(keys[1]), kinds.key
        part = self._table[section][name]
        said = self.resolve(part.get(word), (section, name, word))
        return self._table | {section: {name: part | {word: said}}}

    def _evaluate_once(self, name: str) -> Any:
        if name in self._waiting:
            chain = " -> ".join([*self._waiting[self._waiting.index(name) :], name])
            raise ExpressionError(f"{name} depends on itself ({chain})")
        self._waiting.append(name)
        try:
            if name in self._parameters:
                return self._parameter_value(name)
            found = self.resolve(self._top_level[name], (name,))
            return _defaults().get(name) if found is ABSENT else self._top_level_value(name, found)
        finally:
            self._waiting.pop()

    def _parameter_value(self, name: str) -> Any:
        keys = ("parameters", name)
        table = self.resolve(_parameter_table(self._parameters[name]), keys)
        try:
            return Parameter.model_validate(table).value
        except ValidationError as error:
            raise to_user_error(error, table, self._where, keys) from None

    def _top_level_value(self, name: str, value: Any) -> Any:
        """`value`, once it is what the key may be: else what uses it would be blamed."""
        if name in ScenarioTable.model_fields and name != "dim":
            try:
                _table_of(name).model_validate({name: value}, context={"dim": self._dim})
            except ValidationError as error:
                raise to_user_error(error, {name: value}, self._where) from None
        return value

    def _checked_dim(self) -> int:
        if "dim" not in self._top_level:
            raise self._where.error(("dim",), "dim is missing (2 or 3, the number of dimensions)")
        dim = self["dim"]
        if dim not in (2, 3) or not isinstance(dim, int):
            raise self._where.error(("dim",), f"dim = {dim!r} is not allowed; choose 2 or 3")
        return dim


def _parameter_table(raw: Any) -> dict[str, Any]:
    """A parameter may be written as its bare value."""
    return raw if isinstance(raw, dict) and chooses(raw) is None else {"value": raw}


def _scalars(table: dict[str, Any]) -> dict[str, Any]:
    """Top-level values an expression can use (a number, or something that becomes one)."""
    return {
        key: value
        for key, value in table.items()
        if key in TOP_LEVEL_KEYS - WORDS
        and (not isinstance(value, dict | list) or chooses(value) is not None or _is_number(key))
    }


@cache
def _table_of(key: str) -> type[Table]:
    """A table that has one key of ScenarioTable alone."""
    field = ScenarioTable.model_fields[key]
    of_it: dict[str, Any] = {key: (field.annotation, field)}
    return create_model(key, __base__=Table, **of_it)


def _is_number(key: str) -> bool:
    """Whether a key is a number, so that expressions may use it whatever was given."""
    field = ScenarioTable.model_fields.get(key)
    return field is not None and _has_numbers(field.annotation)


def _has_numbers(kind: Any) -> bool:
    """Whether numbers are of this kind, alone or beside None and texts."""
    if get_origin(kind) is Annotated:
        return _has_numbers(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return any(_has_numbers(each) for each in get_args(kind))
    if get_origin(kind) is Literal:
        return all(isinstance(value, int) for value in get_args(kind))
    return kind in (int, float)


def chooses(value: Any) -> str | None:
    """What a value chooses by: { d2 = ..., d3 = ... } or { ueta2022 = ..., resolved = ... }."""
    if not isinstance(value, dict) or not value:
        return None
    return next((by for by, keys in CHOICES.items() if set(value) <= keys), None)


def _defaults() -> dict[str, Any]:
    return {
        name: field.default
        for name, field in ScenarioTable.model_fields.items()
        if isinstance(field.default, int | float) and field.alias not in WORDS
    }
