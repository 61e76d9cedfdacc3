"""Inflows completed: hydrographs read from files, the normal depth worked out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UserError
from ..util.foreign import check_regular_file
from .particle_files.columns_csv import check_columns, numbers_in, read_csv_columns
from .tables.inflow import Inflow
from .values.toml_source import Where
from .values.types import LARGEST, checked_hydrograph, checked_surge
from .values.units import LENGTH, RATE, SPEED, TIME

HEADERS = {"t": TIME, "Q": RATE}
EXAMPLE = "t [s],Q [L/s]"
SURGE_HEADERS = {"t": TIME, "thickness": LENGTH, "velocity": SPEED}
SURGE = "t [s],thickness [m],velocity [m/s]"
MAX_BYTES = 20_000_000
MAX_ROWS = 100_000


def completed_inflows(
    inflows: Mapping[str, Inflow], gravity: np.ndarray, where: Where
) -> dict[str, Inflow]:
    """The inflows with the rows of their hydrographs and their depths in m; raises UserError."""
    return {name: _completed(name, inflow, gravity, where) for name, inflow in inflows.items()}


def _completed(name: str, inflow: Inflow, gravity: np.ndarray, where: Where) -> Inflow:
    _check_rate(where, name, inflow)
    found: dict[str, Any] = {}
    if isinstance(inflow.surge, str):
        found["surge"] = _from_file(where, name, "surge", inflow.surge)
    if inflow.surge is not None:
        found["depth"] = _highest(found.get("surge", inflow.surge))
    if isinstance(inflow.hydrograph, str):
        found["hydrograph"] = _from_file(where, name, "hydrograph", inflow.hydrograph)
    if inflow.depth == "normal":
        found["depth"] = _normal_depth(where, name, inflow, gravity)
    return inflow.model_copy(update=found)


def _check_rate(where: Where, name: str, inflow: Inflow) -> None:
    """Either a rate and a duration, or a hydrograph."""
    table = f"inflow.{name}"
    if inflow.surge is not None:
        for key in ("rate", "hydrograph", "duration", "depth"):
            if getattr(inflow, key) is not None and not _is_completed(inflow, key):
                raise where.error(
                    ("inflow", name, key), f"{table}.{key} and {table}.surge exclude each other"
                )
        return
    if inflow.depth is None:
        raise where.error(("inflow", name), f"{table}.depth is missing")
    if inflow.hydrograph is None:
        if inflow.rate is None:
            raise where.error(
                ("inflow", name),
                f"{table}.rate is missing, or a hydrograph, which rate and duration exclude",
            )
        if inflow.duration is None:
            raise where.error(
                ("inflow", name),
                f"{table}.duration is missing, which goes with rate; a hydrograph has its own, and "
                f"{table}.rate and {table}.hydrograph exclude each other",
            )
        return
    for key in ("rate", "duration"):
        if getattr(inflow, key) is not None:
            raise where.error(
                ("inflow", name, key), f"{table}.{key} and {table}.hydrograph exclude each other"
            )


def _is_completed(inflow: Inflow, key: str) -> bool:
    """Whether a run has written the depth of its surge itself."""
    return (
        key == "depth" and isinstance(inflow.surge, list) and inflow.depth == _highest(inflow.surge)
    )


def _highest(surge: Any) -> float:
    """The largest thickness of a surge, m."""
    return max(float(row[1]) for row in surge)


def _from_file(where: Where, name: str, key: str, file: str) -> list[list[float]]:
    keys = ("inflow", name, key)
    path = where.file(keys, file)
    try:
        return read_surge(path) if key == "surge" else read_hydrograph(path)
    except (ValueError, UserError) as error:
        place = "" if isinstance(error, UserError) else f"{path}: "
        raise where.error(keys, f"inflow.{name}.{key}: {place}{error}") from None


def read_hydrograph(path: Path) -> list[list[float]]:
    """Rows [t, Q] in s and m3/s of a CSV file with columns t and Q, such as "t [s],Q [L/s]".

    Raises UserError for a file that cannot be read, ValueError for one that is no hydrograph.
    """
    columns = _columns(path, EXAMPLE)
    t, rate = (numbers_in(columns, name, unit, EXAMPLE) for name, unit in HEADERS.items())
    check_columns(columns, HEADERS, EXAMPLE)
    return checked_hydrograph(list(zip(t, rate, strict=True)))


def read_surge(path: Path) -> list[list[float]]:
    """Rows [t, thickness, velocity] in s, m and m/s of a CSV file with such columns.

    The first may be called timestep.  Raises as read_hydrograph does.
    """
    columns = _columns(path, SURGE)
    columns = {name.replace("timestep", "t", 1): values for name, values in columns.items()}
    rows = zip(
        *(numbers_in(columns, name, unit, SURGE) for name, unit in SURGE_HEADERS.items()),
        strict=True,
    )
    check_columns(columns, SURGE_HEADERS, SURGE)
    return checked_surge(list(rows))


def _columns(path: Path, example: str) -> dict[str, np.ndarray]:
    check_regular_file(path)
    if path.stat().st_size > MAX_BYTES:
        raise UserError(f"{path}: a hydrograph may have at most {MAX_BYTES // 10**6} MB")
    columns = read_csv_columns(path, example)
    rows = len(next(iter(columns.values()), ()))
    if rows > MAX_ROWS:
        raise ValueError(f"{rows} rows; at most {MAX_ROWS}, which the run's scenario.toml holds")
    return columns


def _normal_depth(where: Where, name: str, inflow: Inflow, gravity: np.ndarray) -> float:
    """Depth of uniform flow with the inflow's constant rate, m."""
    table = f"inflow.{name}"
    if inflow.hydrograph is not None or inflow.rate is None:
        raise where.error(
            ("inflow", name, "depth"),
            f'{table}.depth = "normal" goes with a constant rate; with a hydrograph give a length',
        )
    if inflow.ks is None:
        raise where.error(("inflow", name), f'{table}.ks is missing: depth = "normal" needs it')
    direction = inflow.along
    pull = float(gravity @ direction)
    if pull <= 0:
        raise where.error(
            ("inflow", name, "direction"),
            f'{table}: depth = "normal" needs a flow down a slope; gravity along the direction is '
            f"{pull:.3g} m/s2",
        )
    try:
        return normal_depth(inflow.rate / inflow.width, pull, inflow.ks)
    except ValueError as error:
        raise where.error(
            ("inflow", name, "ks"), f"{table}.ks = {inflow.ks:g} m: {error}"
        ) from None


def keulegan_rate(depth: float, pull: float, ks: float) -> float:
    """Discharge of uniform flow in a wide rough channel, m2/s (Keulegan 1938).

    q = h u* (6.25 + 5.75 log10(h/ks)) with u* = sqrt(g sin(slope) h); `pull` is g sin(slope), m/s2.
    """
    return depth * math.sqrt(pull * depth) * (6.25 + 5.75 * math.log10(depth / ks))


def normal_depth(rate: float, pull: float, ks: float) -> float:
    """The depth h, m, at which `keulegan_rate` is `rate`, m2/s.

    Raises ValueError where h would be below ks, where the law ends, or absurd.
    """
    low = high = ks
    if keulegan_rate(low, pull, ks) > rate:
        raise ValueError("the normal depth would be less than ks")
    while keulegan_rate(high, pull, ks) < rate:
        high *= 2
        if high > LARGEST:
            raise ValueError(f"the normal depth would be more than {LARGEST:g} m")
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if keulegan_rate(middle, pull, ks) < rate else (low, middle)
    return 0.5 * (low + high)
