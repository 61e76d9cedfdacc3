"""Kinds of values in a scenario file: bounded numbers in their units, vectors, names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, PlainSerializer, ValidationInfo

from ...util.input_file import DIGEST
from .expressions import is_expression
from .units import (
    ACCELERATION,
    ANGLE,
    ANGULAR_SPEED,
    LENGTH,
    LINE_MASS,
    MASS,
    RATE,
    SPEED,
    TIME,
    Measured,
    MeasuredColumns,
)

# A length beyond these is a slip of the keyboard, and would overflow further on.
SMALLEST, LARGEST = 1e-12, 1e12
INFINITIES = ("inf", "+inf", "-inf")


def dimension(info: ValidationInfo) -> int:
    """Of the run whose table is validated: the reader says so."""
    context: dict[str, int] = info.context or {}
    return context["dim"]


def _of_dimension(vector: list[Any], info: ValidationInfo) -> list[Any]:
    dim = dimension(info)
    if len(vector) != dim:
        raise ValueError(f"a {dim}-D run needs {dim} entries here, not {len(vector)}")
    return vector


def _numbers_or_expressions(vector: list[Any]) -> list[Any]:
    for entry in vector:
        number = isinstance(entry, int | float) and not isinstance(entry, bool)
        if not (is_expression(entry) or (number and abs(entry) <= LARGEST)):
            raise ValueError(f'entries must be finite numbers or "= expression", not {entry!r}')
    return vector


def _number_or_expression(value: Any) -> Any:
    return _numbers_or_expressions([value])[0]


def _bound(value: Any) -> Any:
    """TOML can write inf; the strings "inf" and "-inf" mean the same."""
    return float(value) if value in INFINITIES else value


def _not_nan(value: float) -> float:
    if math.isnan(value):
        raise ValueError("nan is not a position")
    return value


def _not_zero(vector: np.ndarray) -> np.ndarray:
    if not np.any(vector):
        raise ValueError("the direction must not be the zero vector")
    return vector


def _grading(rows: list[list[float]]) -> list[list[float]]:
    """Checked rows [d, share of the mass]."""
    for row in rows:
        if len(row) != 2 or not all(SMALLEST <= value <= LARGEST for value in row):
            raise ValueError(f"{row} must be [d, share of the mass], both above 0")
    return rows


def _depth(value: float | str) -> float | str:
    if value != "normal" and not (isinstance(value, float) and SMALLEST <= value <= LARGEST):
        shown = repr(value)[:60]
        raise ValueError(f'{shown} must be a length in m from {SMALLEST:g} on, or "normal"')
    return value


def _hydrograph(value: Any) -> str | list[list[float]]:
    """The path of a CSV file, or checked rows [t, Q] in s and m3/s."""
    if isinstance(value, str) and value:
        return value
    if not isinstance(value, list) or not all(
        isinstance(row, list) and len(row) == 2 for row in value
    ):
        raise ValueError("must be a list of [t, Q] pairs, or the path of a CSV file")
    return checked_hydrograph([(t, rate) for t, rate in value])


def checked_hydrograph(rows: Sequence[tuple[Any, Any]]) -> list[list[float]]:
    """Rows [t, Q] in s and m3/s; raises ValueError where they are no hydrograph."""
    _check_rows(rows)
    if not _carries(rows):
        raise ValueError("nothing would enter; times must go on while some Q is above 0")
    return [[float(t), float(rate)] for t, rate in rows]


def _check_rows(rows: Sequence[tuple[Any, Any]]) -> None:
    """Two rows [t, Q] or more, of numbers, in the order of time; raises ValueError."""
    if len(rows) < 2:
        there = ("no rows", "1 row")[len(rows)]
        raise ValueError(f"{there}; two or more are needed")
    for number, (t, rate) in enumerate(rows, start=1):
        for name, value in (("t", t), ("Q", rate)):
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            if not is_number or not 0 <= value <= LARGEST:
                shown = repr(value)[:60]
                raise ValueError(
                    f"row {number}: {name} = {shown}; allowed: numbers from 0 to {LARGEST:g}"
                )
        if number > 1 and t < rows[number - 2][0]:
            before = rows[number - 2][0]
            raise ValueError(f"row {number}: t = {t:g} s goes back; allowed: {before:g} s or later")


def _carries(rows: Sequence[Sequence[Any]]) -> bool:
    """Whether some time passes between two rows while all that follows their time is above 0."""
    return any(
        first[0] < second[0] and all(max(pair) > 0 for pair in zip(first, second, strict=True))
        for first, second in pairwise(rows)
    )


def _surge(value: Any) -> str | list[list[float]]:
    """The path of a CSV file, or checked rows [t, thickness, velocity] in s, m and m/s."""
    if isinstance(value, str) and value:
        return value
    if not isinstance(value, list) or not all(
        isinstance(row, list) and len(row) == 3 for row in value
    ):
        raise ValueError("must be a list of [t, thickness, velocity], or the path of a CSV file")
    return checked_surge(value)


def checked_surge(rows: Sequence[Sequence[Any]]) -> list[list[float]]:
    """Rows [t, thickness, velocity]; raises ValueError where they are no surge."""
    for number, row in enumerate(rows, start=1):
        for name, value in zip(("t", "thickness", "velocity"), row, strict=True):
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            if not is_number or not 0 <= value <= LARGEST:
                shown = repr(value)[:60]
                raise ValueError(
                    f"row {number}: {name} = {shown}; allowed: numbers from 0 to {LARGEST:g}"
                )
    _check_rows([(t, thickness * velocity) for t, thickness, velocity in rows])
    if not _carries(rows):
        raise ValueError(
            "nothing would enter; times must go on while thickness and velocity are both above 0"
        )
    return [[float(value) for value in row] for row in rows]


def _skin(value: float | str) -> float | str:
    if value != "auto" and not (isinstance(value, float) and 0 <= value <= 1):
        raise ValueError('must be a number from 0 to 1, or "auto"')
    return value


def _one_line(value: str) -> str:
    if not value.isprintable():
        raise ValueError("must be one line, without control characters")
    return value


def _digest(value: str) -> str:
    if not DIGEST.fullmatch(value):
        raise ValueError("must be 32 hexadecimal digits, as in scenario.toml of a run")
    return value


def _precision(value: object) -> object:
    """Files of version 0.1 call it float."""
    return "mixed" if value == "float" else value


def _entries(count: int) -> AfterValidator:
    def check(vector: list[Any]) -> list[Any]:
        if len(vector) != count:
            raise ValueError(f"{count} entries are needed here, not {len(vector)}")
        return vector

    return AfterValidator(check)


@dataclass(frozen=True)
class RefersTo:
    """What a key names: a table of this section."""

    section: str


Positive = Annotated[float, Field(gt=0)]
Title = Annotated[str, Field(max_length=300), AfterValidator(_one_line)]
Digest = Annotated[str, AfterValidator(_digest)]
Length = Annotated[float, Field(ge=SMALLEST, le=LARGEST), Measured(LENGTH)]
Duration = Annotated[float, Field(gt=0), Measured(TIME)]
Instant = Annotated[float, Field(ge=0), Measured(TIME)]
Speed = Annotated[float, Field(gt=0), Measured(SPEED)]
Angle = Annotated[float, Measured(ANGLE)]
ParticleMass = Annotated[float, Field(gt=0), Measured(MASS, plane=LINE_MASS)]
Coordinate = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
NonNegative = Annotated[float, Field(ge=0)]
VectorField = Annotated[
    list[Any], AfterValidator(_of_dimension), AfterValidator(_numbers_or_expressions)
]
VelocityField = Annotated[VectorField, Measured(SPEED)]
DisplacementField = Annotated[VectorField, Measured(LENGTH)]
ScalarField = Annotated[Any, AfterValidator(_number_or_expression)]
Bound = Annotated[
    float,
    Field(allow_inf_nan=True),
    BeforeValidator(_bound),
    AfterValidator(_not_nan),
]
Precision = Annotated[Literal["double", "mixed"], BeforeValidator(_precision)]
MaterialName = Annotated[str, RefersTo("material")]
BodyNames = Annotated[list[str], RefersTo("body"), Field(min_length=1)]
GaugeName = Annotated[str, RefersTo("gauge")]
OptionalWindowName = Annotated[str | None, RefersTo("window")]
OptionalMaterialName = Annotated[str | None, RefersTo("material")]

# Lists in the file, arrays (dim,) in a scenario.
if TYPE_CHECKING:
    Vector: TypeAlias = np.ndarray
    Position: TypeAlias = np.ndarray
    Velocity: TypeAlias = np.ndarray
    Acceleration: TypeAlias = np.ndarray
    Spin: TypeAlias = float | np.ndarray
    Direction: TypeAlias = np.ndarray
    Corner: TypeAlias = np.ndarray
else:
    _AS_ARRAY = (
        AfterValidator(_of_dimension),
        AfterValidator(np.array),
        PlainSerializer(np.ndarray.tolist, return_type=list),
    )
    Vector = Annotated[list[Coordinate], *_AS_ARRAY]
    Position = Annotated[Vector, Measured(LENGTH)]
    Velocity = Annotated[Vector, Measured(SPEED)]
    Acceleration = Annotated[Vector, Measured(ACCELERATION)]
    Spin = Annotated[float | Vector, Measured(ANGULAR_SPEED)]
    Direction = Annotated[Vector, AfterValidator(_not_zero)]
    Corner = Annotated[list[Bound], *_AS_ARRAY, Measured(LENGTH, words=INFINITIES)]
Rate = Annotated[float, Field(gt=0, le=LARGEST), Measured(RATE)]
Mass = Annotated[float, Field(gt=0, le=LARGEST), Measured(MASS)]
Grading = Annotated[
    list[list[float]],
    Field(min_length=1),
    AfterValidator(_grading),
    MeasuredColumns((LENGTH, None)),
]
Depth = Annotated[float | str, AfterValidator(_depth), Measured(LENGTH, words=("normal",))]
Hydrograph = Annotated[Any, AfterValidator(_hydrograph), MeasuredColumns((TIME, RATE))]
MapPoint = Annotated[list[Coordinate], _entries(2), Measured(LENGTH)]  # x, y on a map
Extent = Annotated[list[Coordinate], _entries(4), Measured(LENGTH)]  # west, south, east, north
Surge = Annotated[Any, AfterValidator(_surge), MeasuredColumns((TIME, LENGTH, SPEED))]
Axis = Literal["x", "y", "z"]
Skin = Annotated[float | str, AfterValidator(_skin)]
