"""Parts that stand for several: arrays of copies, tanks of walls."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ...errors import UserError
from ...util.foreign import check_regular_file
from ..array import MAX_COPIES, Array
from ..particle_files.columns_csv import numbers_in, read_csv_columns
from ..table import Table
from ..tables.sections import SECTIONS, table_at
from ..values.toml_source import KeyPath, Where, dotted
from ..values.types import RefersTo
from ..values.units import ANGLE, LENGTH
from .messages import to_user_error
from .placing import Part, mirrored, moved, turned
from .tank import walls_of_tank

MAX_BYTES = 20_000_000
EXAMPLE = {2: "x [mm],y [mm],angle", 3: "x [mm],y [mm],z [mm],angle"}
Copies = dict[str, Part]  # by name


def with_copies(table: dict[str, Any], where: Where) -> dict[str, Any]:
    """The table with parts of their own in place of those that stand for several.

    What refers to such a part refers to all of them.  Raises UserError.
    """
    found = dict(table)
    made: dict[str, dict[str, list[str]]] = {}
    for section in SECTIONS:
        parts = table.get(section)
        if isinstance(parts, dict):
            found[section], made[section] = _expanded(table, section, parts, where)
    return {key: _referring(key, value, made) for key, value in found.items()}


def _expanded(
    table: dict[str, Any], section: str, parts: dict[str, Any], where: Where
) -> tuple[dict[str, Any], dict[str, list[str]]]:
    """The parts of a section, and the names of what some of them stand for."""
    found: dict[str, Any] = {}
    made: dict[str, list[str]] = {}
    for name, part in parts.items():
        copies = _copies(table, (section, name), part, where)
        if copies is None:
            found[name] = part
            continue
        made[name] = list(copies)
        for copy, values in copies.items():
            if copy in parts:
                raise where.error((section, copy), f"{section}.{copy}: {name} has a copy so named")
            where.note_copy((section, copy), (section, name))
            found[copy] = values
    return found, made


def _copies(table: dict[str, Any], keys: KeyPath, part: Any, where: Where) -> Copies | None:
    """What a part stands for; None: itself."""
    if not isinstance(part, dict):
        return None
    kind = table_at(keys, table)
    is_tank = keys[0] == "body" and part.get("shape") == "tank"
    if "array" in part and part.get("shape") == "release":
        at = (*keys, "array")
        raise where.error(at, f"{dotted(at)}: a release has no copies: list several polygons")
    has_array = "array" in part and kind is not None and "array" in kind.model_fields
    if not is_tank and not has_array:
        return None
    try:
        if not has_array:
            return walls_of_tank(table, str(keys[1]), part)
        array = Array.model_validate(part["array"], context={"dim": table["dim"]})
        assert kind is not None
        return _array(table, keys, part, array, kind, where)
    except ValidationError as error:
        above = (*keys, "array") if has_array else keys
        inner = part["array"] if has_array else part
        inner = inner if isinstance(inner, dict) else {}
        raise to_user_error(error, inner, where, above) from None
    except (ValueError, OverflowError) as error:
        at = (*keys, "array") if has_array else keys
        raise where.error(at, f"{dotted(at)}: {error}") from None


def _array(
    table: dict[str, Any], keys: KeyPath, part: Part, array: Array, kind: type[Table], where: Where
) -> Copies:
    plain = {key: value for key, value in part.items() if key != "array"}
    dim, name = table["dim"], str(keys[1])
    if array.mirror is not None:
        assert array.at is not None
        if "xyz".index(array.mirror) >= dim:
            raise ValueError(f'a {dim}-D run has no axis "{array.mirror}"')
        if dim == 3 and (keys[0] == "inflow" or {"width", "direction"} <= set(plain)):
            what = "an inflow" if keys[0] == "inflow" else "a section with a width"
            raise ValueError(f"{what} of a 3-D run has no mirrored copy; write it out")
        copies = [plain, mirrored(plain, "xyz".index(array.mirror), array.at)]
    elif array.turns is not None:
        assert array.about is not None
        step = 360 / array.turns if array.angle is None else array.angle
        _check_number(array.turns)
        copies = [turned(plain, kind, k * step, array.about) for k in range(array.turns)]
    elif array.file is not None:
        path = where.file((*keys, "array", "file"), array.file)
        copies = []
        for *shift, angle in _placements(path, dim):
            at = moved(plain, np.array(shift))
            copies.append(turned(at, kind, angle, _reference(at)) if angle else at)
    else:
        copies = [moved(plain, shift) for shift in _shifts(array)]
    return {f"{name}.{number}": copy for number, copy in enumerate(copies, start=1)}


def _reference(part: Part) -> np.ndarray:
    """The point about which a copy of a file is turned: its pivot, corner, centre or position."""
    for key in ("pivot", "min", "centre", "position"):
        if key in part and np.ndim(part[key]) == 1:
            return np.array(part[key], dtype=float)
    raise ValueError("an angle needs a pivot to be turned about")


def _shifts(array: Array) -> Iterator[np.ndarray]:
    """The vectors of a lattice, the first axis fastest; every second row may be staggered."""
    assert array.count is not None
    assert array.step is not None
    _check_number(int(np.prod(np.array(array.count, dtype=float))))
    stagger = np.zeros(len(array.step)) if array.stagger is None else array.stagger
    for index in product(*(range(count) for count in reversed(array.count))):
        cell = np.array(index[::-1])
        yield cell * array.step + (index[0] % 2) * stagger


def _check_number(copies: int) -> None:
    if copies > MAX_COPIES:
        raise ValueError(f"{copies} copies; at most {MAX_COPIES}")


def _placements(path: Path, dim: int) -> list[list[float]]:
    """Rows of shift, m, and angle, degrees; raises ValueError for what is none."""
    try:
        check_regular_file(path)
        if path.stat().st_size > MAX_BYTES:
            raise ValueError(f"{path}: placements may have at most {MAX_BYTES // 10**6} MB")
        columns = read_csv_columns(path, EXAMPLE[dim])
    except UserError as error:
        raise ValueError(str(error)) from None
    rows = len(next(iter(columns.values())))
    _check_number(rows)
    known = {*"xyz"[:dim], "angle"}
    for header in columns:
        if header.split("[")[0].split("(")[0].strip().lower() not in known:
            raise ValueError(f'{path}: "{header}" is no column; allowed: {EXAMPLE[dim]}')
    try:
        found = [numbers_in(columns, axis, LENGTH, EXAMPLE[dim]) for axis in "xyz"[:dim]]
        has_angle = any(header.lower().startswith("angle") for header in columns)
        angles = numbers_in(columns, "angle", ANGLE, EXAMPLE[dim]) if has_angle else [0.0] * rows
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if not rows or not np.isfinite([*found, angles]).all():
        raise ValueError(f"{path}: there must be rows, of finite numbers")
    return [list(row) for row in zip(*found, angles, strict=True)]


def _referring(section: str, parts: Any, made: dict[str, dict[str, list[str]]]) -> Any:
    """The parts of a section with names of several in place of the name that stands for them."""
    kind = SECTIONS.get(section)
    if kind is None or not isinstance(parts, dict):
        return parts
    found = {}
    for name, part in parts.items():
        table = table_at((section, name), {section: parts})
        changed = dict(part) if isinstance(part, dict) else part
        for key, field in table.model_fields.items() if table and isinstance(part, dict) else ():
            refers = [about.section for about in field.metadata if isinstance(about, RefersTo)]
            if refers and isinstance(part.get(key), list):
                copies = made.get(refers[0], {})
                changed[key] = [new for old in part[key] for new in _copies_of(old, copies)]
        found[name] = changed
    return found


def _copies_of(name: Any, copies: dict[str, list[str]]) -> list[Any]:
    """The names that one stands for; what is no name is left to the reading of the table."""
    return copies.get(name, [name]) if isinstance(name, str) else [name]
