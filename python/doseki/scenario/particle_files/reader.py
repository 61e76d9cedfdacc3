"""Particles read from a file: a CSV with a header, or HDF5 with one dataset per column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import UserError
from ...util.foreign import check_regular_file
from ...util.spelling import suggestion
from ..values.types import LARGEST
from .columns_csv import read_csv_columns
from .columns_hdf5 import is_hdf5, read_hdf5_columns

TRUTH = {"0": False, "1": True, "false": False, "true": True, "0.0": False, "1.0": True}


@dataclass
class ParticleTable:
    """N particles as a file gives them; an optional column that is absent is None."""

    position: np.ndarray  # (N, dim), m
    velocity: np.ndarray  # (N, dim), m/s
    mass: np.ndarray  # (N,), kg (2-D: kg/m)
    density: np.ndarray  # (N,), kg/m3
    material: np.ndarray  # (N,) int, index into material_names
    material_names: list[str]
    fixed: np.ndarray | None  # (N,) bool
    body: np.ndarray | None  # (N,) int, index into body_names
    body_names: list[str]
    smoothing_length: np.ndarray | None  # (N,), m
    columns: frozenset[str]  # those that the file has

    def __len__(self) -> int:
        return len(self.mass)


def read_particles(path: Path, dim: int, default_material: str | None) -> ParticleTable:
    """Read x, y[, z], vx, vy[, vz], mass, density, material[, fixed][, body][, smoothing_length].

    `default_material` stands in for an absent column `material`.  Raises UserError, naming file,
    column and row, for anything else than finite numbers, positive masses and densities.
    """
    check_regular_file(path)
    axes = "xyz"[:dim]
    positions, velocities = list(axes), [f"v{axis}" for axis in axes]
    required = [*positions, *velocities, "mass", "density"]
    required += [] if default_material else ["material"]
    optional = ["material", "fixed", "body", "smoothing_length"]
    columns = (read_hdf5_columns if is_hdf5(path) else read_csv_columns)(path)
    _check_names(path, columns, required, [*required, *optional])
    given = frozenset(columns)
    columns = {"material": np.full(_rows(columns), default_material or ""), **columns}
    material, material_names = _codes(path, "material", columns["material"])
    body, body_names = _optional_body(path, columns.get("body"))
    return ParticleTable(
        position=np.column_stack([_numbers(path, name, columns[name]) for name in positions]),
        velocity=np.column_stack([_numbers(path, name, columns[name]) for name in velocities]),
        mass=_positive(path, "mass", columns["mass"]),
        density=_positive(path, "density", columns["density"]),
        material=material,
        material_names=material_names,
        fixed=_truths(path, "fixed", columns["fixed"]) if "fixed" in columns else None,
        body=body,
        body_names=body_names,
        smoothing_length=_positive(path, "smoothing_length", columns["smoothing_length"])
        if "smoothing_length" in columns
        else None,
        columns=given,
    )


def _rows(columns: Mapping[str, np.ndarray]) -> int:
    return len(next(iter(columns.values())))


def _check_names(
    path: Path, columns: Mapping[str, np.ndarray], required: list[str], known: list[str]
) -> None:
    for name in columns:
        if name not in known:
            raise UserError(f'{path}: unknown column "{name}"{suggestion(name, known)}')
    missing = [name for name in required if name not in columns]
    if missing:
        raise UserError(
            f"{path}: missing column{'s' * (len(missing) > 1)} {', '.join(missing)}; "
            f"needed: {', '.join(required)}"
        )
    if _rows(columns) == 0:
        raise UserError(f"{path}: holds no particle")


def _fail(path: Path, name: str, values: np.ndarray, wrong: np.ndarray, expected: str) -> None:
    """Raise UserError about the first row where `wrong` is true."""
    if wrong.any():
        row = int(np.argmax(wrong))
        raise UserError(
            f'{path}, particle {row + 1}: column "{name}" has {str(values[row])[:40]!r}, '
            f"expected {expected}"
        )


def _numbers(path: Path, name: str, values: np.ndarray) -> np.ndarray:
    """The column as finite float64, small enough for what is computed from it."""
    try:
        numbers = values.astype(np.float64)
    except (ValueError, TypeError):
        _fail(path, name, values, ~np.array([_is_number(v) for v in values]), "a number")
        raise
    wrong = ~(np.abs(numbers) <= LARGEST)  # also where it is nan
    _fail(path, name, values, wrong, f"a finite number of at most {LARGEST:g}")
    return numbers


def _is_number(value: object) -> bool:
    try:
        float(str(value))
    except ValueError:
        return False
    return True


def _positive(path: Path, name: str, values: np.ndarray) -> np.ndarray:
    numbers = _numbers(path, name, values)
    _fail(path, name, values, numbers <= 0, "a number greater than 0")
    return numbers


def _truths(path: Path, name: str, values: np.ndarray) -> np.ndarray:
    """The column as booleans: 0, 1, true or false."""
    words = np.char.lower(values.astype(str))
    kinds, codes = np.unique(words, return_inverse=True)
    known = np.array([kind in TRUTH for kind in kinds])
    _fail(path, name, values, ~known[codes], "0, 1, true or false")
    return np.array([TRUTH[kind] for kind in kinds])[codes]


def _codes(path: Path, name: str, values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """The column as names: an index for each row, and the names."""
    if values.dtype.kind not in "US":
        raise UserError(f'{path}: column "{name}" must hold names, not numbers')
    _fail(path, name, values, values == "", "a name")
    names, codes = np.unique(values, return_inverse=True)
    return codes, [str(entry) for entry in names]


def _optional_body(path: Path, values: np.ndarray | None) -> tuple[np.ndarray | None, list[str]]:
    """Bodies are names or whole numbers, which serve as names."""
    if values is None:
        return None, []
    if values.dtype.kind == "f":
        _fail(path, "body", values, values != np.floor(values), "a name or a whole number")
        values = values.astype(np.int64)
    return _codes(path, "body", values.astype(str))
