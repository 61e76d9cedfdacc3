"""Strings such as "25 mm" become numbers in the units of their keys: expressions see numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias, get_args

from ..table import Kinds, Table
from ..tables.parameter import Parameter
from ..tables.root import ScenarioTable
from ..tables.sections import SECTIONS
from ..values.expressions import is_expression
from ..values.toml_source import KeyPath, Where, dotted
from ..values.units import Measured, MeasuredColumns, Unit, quantity, unit_named
from .resolve import CHOICES

Spec: TypeAlias = "Measured | MeasuredColumns | Mapping[str, Spec] | None"
_OF_CHOICES = set().union(*CHOICES.values())


def in_own_units(table: dict[str, Any], where: Where) -> dict[str, Any]:
    """The table with every string that names a unit in place of its number in that of its key.

    Raises UserError where it names a unit that the key does not have.
    """
    reader = _Reader(table.get("dim"), where)
    return {key: _converted(key, value, reader) for key, value in table.items()}


def _converted(key: str, value: Any, reader: _Reader) -> Any:
    """What stands at a key of the top level, or all tables of a section."""
    if key not in SECTIONS:
        return reader.read(value, OF_TOP_LEVEL.get(key), (key,))
    if not isinstance(value, dict):
        return value
    if key == "parameters":
        return {name: _parameter(part, reader, (key, name)) for name, part in value.items()}
    specs = OF_SECTIONS[key]
    return {name: reader.read(part, specs, (key, name)) for name, part in value.items()}


def specs_of(kind: type[Table]) -> dict[str, Spec]:
    """What the keys of a kind of table measure; those that hold plain numbers are left out."""
    found = {}
    for name, field in kind.model_fields.items():
        spec = next(_specs_in((*field.metadata, field.annotation)), None)
        if spec:
            found[field.alias or name] = spec
    return found


def _specs_in(annotations: Any) -> Any:
    """What annotations of a key say about its units, also in their parts."""
    for about in annotations:
        if isinstance(about, Measured | MeasuredColumns):
            yield about
        elif isinstance(about, type) and issubclass(about, Table):
            yield specs_of(about)
        else:
            yield from _specs_in(get_args(about))


def _specs_of_section(kind: type[Table] | Kinds) -> dict[str, Spec]:
    """The same for the tables of a section: a key measures the same in all its kinds."""
    kinds = kind.tables.values() if isinstance(kind, Kinds) else [kind]
    return {key: spec for table in kinds for key, spec in specs_of(table).items()}


OF_TOP_LEVEL = {key: spec for key, spec in specs_of(ScenarioTable).items() if key not in SECTIONS}
OF_SECTIONS = {name: _specs_of_section(kind) for name, kind in SECTIONS.items()}


def unit_of(name: str, dim: int) -> str:
    """The unit of a number at a key, named as --set does (`dp`); empty where none is known."""
    first, *inner = name.split(".")
    spec: Spec = OF_SECTIONS[first] if first in SECTIONS else OF_TOP_LEVEL.get(first)
    for key in inner[1:] if first in SECTIONS else inner:
        spec = _of_key(spec, key)
    return spec.unit_in(dim).own if isinstance(spec, Measured) else ""


class _Reader:
    """Converts values of a run of so many dimensions."""

    def __init__(self, dim: Any, where: Where) -> None:
        self._dim, self._where = dim, where

    def read(self, value: Any, spec: Spec, keys: KeyPath) -> Any:
        """The value at `keys`, with strings that name a unit converted."""
        if isinstance(value, dict):
            return {
                key: self.read(inner, _of_key(spec, key), (*keys, key))
                for key, inner in value.items()
            }
        if not isinstance(spec, Measured | MeasuredColumns):
            return value
        if isinstance(value, list):
            return [
                self.read(inner, spec.within(index), (*keys, index))
                for index, inner in enumerate(value)
            ]
        if not isinstance(value, str) or is_expression(value) or isinstance(spec, MeasuredColumns):
            return value
        if value in spec.words:
            return value
        return self.number(value, spec.unit_in(self._dim), keys, spec.words)

    def number(self, text: str, unit: Unit, keys: KeyPath, words: Sequence[str] = ()) -> float:
        """The number that a string gives; `words` are what else a key may have."""
        found = unit.read(text)
        if found is None:
            shown = text if len(text) <= 60 else text[:57] + "..."
            others = "".join(f', "{word}"' for word in words)
            raise self._where.error(
                keys,
                f'{dotted(keys)} = "{shown}" is not {unit.what}; allowed: {unit.allowed}{others},'
                ' or an expression such as "= 1/60"',
            )
        return found


def _of_key(spec: Spec, key: str) -> Spec:
    """The same for what a choice names; else what a key of a table measures."""
    return spec.get(key) if isinstance(spec, Mapping) and key not in _OF_CHOICES else spec


def _parameter(raw: Any, reader: _Reader, keys: KeyPath) -> Any:
    """A parameter in the unit that it declares; without one, quantities become SI units."""
    unit = raw.get("unit") if isinstance(raw, dict) else None
    if not isinstance(raw, dict) or not set(raw) & set(Parameter.model_fields):
        return _number_in(raw, None, reader, keys)
    numbers = {"value", "min", "max", "choices"}
    return {
        key: _number_in(value, unit, reader, (*keys, key)) if key in numbers else value
        for key, value in raw.items()
    }


def _number_in(value: Any, unit: Any, reader: _Reader, keys: KeyPath) -> Any:
    """A value of a parameter, or each of several, in a declared unit."""
    if isinstance(value, dict):
        return {key: _number_in(v, unit, reader, (*keys, key)) for key, v in value.items()}
    if isinstance(value, list):
        return [_number_in(v, unit, reader, (*keys, i)) for i, v in enumerate(value)]
    if not isinstance(value, str) or is_expression(value) or quantity(value) is None:
        return value
    declared = unit_named(unit) if isinstance(unit, str) else None
    if declared is None:
        found = quantity(value)
        return value if found is None else found[0]
    return reader.number(value, declared, keys) / (declared.factor(unit) or 1.0)
