"""The scenario in the folder of a run, as far as what reads records takes it for granted."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, FiniteFloat, ValidationError, model_validator

from ..errors import UserError
from ..util.foreign import read_toml_table

Positive = Annotated[FiniteFloat, Field(gt=0)]
Point = Annotated[list[FiniteFloat], Field(min_length=2, max_length=3)]
# What a value must be, by how the names of pydantic's objections to others begin.
EXPECTED = {
    "float": "a number",
    "finite": "a finite number",
    "greater": "a number above 0",
    "list": "a list",
    "dict": "a table",
    "string": "a text",
    "too_short": "a list of two or three numbers",
    "too_long": "a list of two or three numbers",
}
Tables = dict[str, dict[str, Any]]


class _Needed(BaseModel):
    """Keys that are read without another look; of tables, only that they are some."""

    dim: Literal[2, 3]
    dp: Positive
    time_max: Positive
    xi: Positive = 1.0
    scheme: str = ""
    kernel: str = ""
    title: str = ""
    gravity: Point | None = None
    periodic: list[Literal["x", "y", "z"]] = []
    domain_min: Point | None = None
    domain_max: Point | None = None
    maps: dict[str, Any] | None = None
    material: Tables = {}
    body: Tables = {}
    inflow: Tables = {}
    outflow: Tables = {}
    gauge: Tables = {}
    window: Tables = {}
    figure: Tables = {}

    @model_validator(mode="after")
    def _fits_together(self) -> _Needed:
        points = {key: getattr(self, key) for key in ("gravity", "domain_min", "domain_max")}
        for key, point in points.items():
            if point is not None and len(point) != self.dim:
                raise ValueError(f"{key}: a {self.dim}-D run needs {self.dim} entries")
        if self.periodic and None in (self.domain_min, self.domain_max):
            raise ValueError("periodic needs domain_min and domain_max")
        return self


def recorded_scenario(path: Path) -> dict[str, Any]:
    """The effective scenario of a run; raises UserError for what no run has written."""
    table = read_toml_table(path)
    try:
        _Needed.model_validate(table)
    except ValidationError as error:
        wrong = _wrong(error.errors()[0])
        raise UserError(f"{path}: no run has written this: {wrong}") from None
    return table


def _wrong(objection: Any) -> str:
    """What is wrong with a key, in our words."""
    key, kind = ".".join(map(str, objection["loc"])), objection["type"]
    if kind == "missing":
        return f"{key} is missing"
    if kind == "value_error":
        return str(objection["ctx"]["error"])
    said = f"{key} = {str(objection['input'])[:40]}"
    if kind == "literal_error":
        return f"{said} must be {objection['ctx']['expected']}"
    what = next((words for type_, words in EXPECTED.items() if kind.startswith(type_)), None)
    return f"{said} is not allowed" if what is None else f"{said} must be {what}"
