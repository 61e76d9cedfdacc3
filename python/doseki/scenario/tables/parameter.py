"""[parameters]: numbers and words that are set by name and used in expressions."""

from __future__ import annotations

import sys
from typing import Any

from pydantic import Field, model_validator

from ..table import Table


class Parameter(Table):
    """A number or word of the scenario itself, to be set by name and used in expressions."""

    value: Any = Field(description="a number, true/false or a word")
    min: float | None = Field(None, description="smallest allowed value")
    max: float | None = Field(None, description="largest allowed value")
    choices: list[Any] | None = Field(None, description="the allowed values")
    unit: str = Field("", description="unit of the value")
    help: str = Field("", description="what it is")

    @model_validator(mode="after")
    def _allowed(self) -> Parameter:
        value = self.value
        if not isinstance(value, int | float | str):
            raise ValueError("must be a number, true/false or a word")
        if self.choices is not None and value not in self.choices:
            raise ValueError(f"{value!r} is not one of {', '.join(map(str, self.choices))}")
        if isinstance(value, bool | str):
            if self.min is not None or self.max is not None:
                raise ValueError(f"must be a number, not {value!r}")
            return self
        if not abs(value) <= sys.float_info.max:
            raise ValueError("must be finite")
        if self.min is not None and value < self.min:
            raise ValueError(f"{value!r} is out of range; must be {self._shown(self.min)} or more")
        if self.max is not None and value > self.max:
            raise ValueError(f"{value!r} is out of range; must be {self._shown(self.max)} or less")
        return self

    def _shown(self, bound: float) -> str:
        return f"{bound:g} {self.unit}".rstrip()
