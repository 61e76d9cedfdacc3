"""What every table of a scenario file has, and sections whose tables are of several kinds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Union, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag


class Table(BaseModel):
    """A table of a scenario file: no unknown key, no silent conversion, finite numbers."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        arbitrary_types_allowed=True,
    )

    def given(self, key: str) -> Any:
        """The value of a key; None where this kind of table has no such key."""
        return getattr(self, key, None) if key in type(self).model_fields else None

    def has_default(self, key: str) -> bool:
        """Whether a key has the value that it has where it is not given."""
        default = type(self).model_fields[key].get_default(call_default_factory=True)
        return bool(np.array_equal(getattr(self, key), default))


class Part(Table):
    """A named table that can be switched off."""

    enabled: bool = Field(True, description="false: as if the table were not there")


@dataclass(frozen=True)
class Only:
    """Where alone a key means something; elsewhere nothing but its default may be given.

    It annotates the type of a key.
    """

    scheme: str | None = None
    dim: int | None = None
    fixed: bool | None = None  # of bodies

    def allows(self, scheme: str, dim: int) -> bool:
        """Whether the key means something in such a run."""
        return self.scheme in (None, scheme) and self.dim in (None, dim)


def limited_keys(kind: type[Table]) -> Iterator[tuple[str, Only]]:
    """The keys of a kind of table that mean something in some runs alone."""
    for name, field in kind.model_fields.items():
        for about in field.metadata:
            if isinstance(about, Only):
                yield name, about


def only_kind(table: type[Table], key: str) -> str:
    """The word that `key` must have in this kind of table."""
    return str(get_args(table.model_fields[key].annotation)[0])


class Kinds:
    """The tables of a section that has several kinds of them, told apart by one key."""

    def __init__(
        self,
        key: str,
        common: type[Table],
        tables: Mapping[str, type[Table]],
        special: Callable[[dict[str, Any]], str | None] = lambda table: None,
    ) -> None:
        """`common` is the base of all `tables`; `special` may tell a kind from other keys.

        The names that `special` gives are no words of a scenario.
        """
        self.key, self.common, self.tables = key, common, dict(tables)
        self._special = special

    @classmethod
    def by_word(cls, key: str, common: type[Table], *tables: type[Table]) -> Kinds:
        """Kinds whose names are the words that `key` must have."""
        return cls(key, common, {only_kind(table, key): table for table in tables})

    def name_of(self, table: Any) -> str | None:
        """The name of the kind of a table, or whatever word it says; None where it says none."""
        if isinstance(table, Table):
            return next((n for n, kind in self.tables.items() if type(table) is kind), None)
        if not isinstance(table, dict):
            return None
        said = table.get(self.key)
        return self._special(table) or (None if said is None else str(said))

    @property
    def words(self) -> list[str]:
        """What a scenario may say."""
        key = self.key
        words = [w for t in self.tables.values() for w in get_args(t.model_fields[key].annotation)]
        return list(dict.fromkeys(words))

    def of(self, table: Any) -> type[Table]:
        """The kind of a table; what all kinds have where it is none of them."""
        return self.tables.get(self.name_of(table) or "", self.common)

    @property
    def union(self) -> Any:
        """The type of a table of any of the kinds."""
        members = [Annotated[t, Tag(self.tag(name))] for name, t in self.tables.items()]
        # An operator cannot join a list of types.
        return Annotated[Union[tuple(members)], Discriminator(self._tag_of), self]  # noqa: UP007

    def tag(self, name: str) -> str:
        """What validation calls a kind: no key of any table."""
        return f"{self.key} = {name}"

    def _tag_of(self, table: Any) -> str | None:
        name = self.name_of(table)
        return None if name is None else self.tag(name)
