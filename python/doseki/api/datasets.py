"""The particles of several snapshots as one Dataset of xarray, or one DataFrame of pandas."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ResourceError, UserError
from ..record.fields import FIELD_BY_KEY, SYMMETRIC, ParticleField
from ..record.reader import Run, Snapshot
from ..util.extras import extra
from ..util.memory import available_bytes
from ..util.spelling import suggestion
from .frames import attributes, frame_of

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

DEFAULT = ("position", "velocity", "density", "pressure", "mass")
OF_PARTICLE = ("id", "material", "body")  # that do not change
AXES = ["x", "y", "z"]
SHARE = 0.5  # of the free memory that a Dataset may take
COPIES = 2.5  # of its numbers that are in memory while it is made

Times = float | Sequence[float] | slice | None


def particles_dataset(
    run: Run, fields: Sequence[str] | None = None, times: Times = None
) -> xr.Dataset:
    """Fields of particles over `time` and `particle`; see doseki.Run.to_xarray."""
    with extra("analysis", "to_xarray()"):
        import xarray as xr
    chosen, snapshots = _fields(fields), _snapshots(run, times)
    dim = int(run.scenario["dim"])
    ids, names = _particles(snapshots)
    _check_memory(len(snapshots) * len(ids) * sum(_width(field, dim) for field in chosen))
    arrays = [_empty(field, len(snapshots), len(ids), dim) for field in chosen]
    present = np.zeros((len(snapshots), len(ids)), bool)
    for row, snapshot in enumerate(snapshots):
        place = np.searchsorted(ids, snapshot["id"])
        present[row, place] = True
        for field, array in zip(chosen, arrays, strict=True):
            array[row, place] = snapshot[field.key]
    found = xr.Dataset(
        coords={
            "time": ("time", [snapshot.time for snapshot in snapshots], attributes("time", "s")),
            "particle": ("particle", ids, attributes("id of the particle", "")),
            **{name: ("particle", values) for name, values in names.items()},
        },
        attrs={"title": run.scenario.get("title", ""), "source": "doseki", "dim": dim},
    )
    for field, array in zip(chosen, arrays, strict=True):
        found[field.key] = _dims(field), array, _attributes(field, dim)
    found["present"] = (
        ("time", "particle"),
        present,
        attributes("whether the particle is there", ""),
    )
    return found.assign_coords(_axes(found, dim))


def particles_frame(
    run: Run, fields: Sequence[str] | None = None, times: Times = None
) -> pd.DataFrame:
    """A row for each particle and time; see doseki.Run.to_pandas."""
    chosen, snapshots = _fields(fields), _snapshots(run, times)
    dim = int(run.scenario["dim"])
    rows = sum(len(snapshot["id"]) for snapshot in snapshots)
    _check_memory(rows * (4 + sum(_width(field, dim) for field in chosen)))
    parts = [_columns(snapshot, chosen, dim) for snapshot in snapshots]
    units = {name: field.unit_in(dim) for field in chosen for name, _ in _components(field, dim)}
    table = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    frame = frame_of(table, {"time": "s", "id": "", "material": "", "body": ""} | units)
    for name in ("material", "body"):
        frame[name] = frame[name].astype("category")
    return frame


def _fields(names: Sequence[str] | None) -> list[ParticleField]:
    if isinstance(names, str):
        names = [names]
    for name in names or ():
        if name in OF_PARTICLE:
            raise UserError(f"fields: {name} is always there; leave it out")
        if name not in FIELD_BY_KEY:
            raise UserError(f"fields: {name!r} is not a field{suggestion(name, FIELD_BY_KEY)}")
    return [FIELD_BY_KEY[name] for name in dict.fromkeys(DEFAULT if names is None else names)]


def _snapshots(run: Run, times: Times) -> list[Snapshot]:
    """The snapshots of these times; of two at one time, as a stopped run has them, the first."""
    if times is None:
        times = slice(None)
    if isinstance(times, slice):
        if times.step is not None:
            raise UserError("times: a slice of times has no step; name the times")
        low = -np.inf if times.start is None else times.start
        high = np.inf if times.stop is None else times.stop
        known = run.times
        found = [run[int(k)] for k in np.flatnonzero((low <= known) & (known <= high))]
    else:
        found = [run.at(float(time)) for time in np.sort(np.atleast_1d(times))]
    if not found:
        raise UserError(f"{run.directory}: no snapshot at these times")
    return [next(same) for _, same in groupby(found, key=lambda snapshot: snapshot.time)]


def _particles(snapshots: list[Snapshot]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Ids (P,) of all particles that ever are there, in order, and names of what each is of."""
    ids = np.unique(np.concatenate([snapshot["id"] for snapshot in snapshots]))
    names: dict[str, np.ndarray] = {}
    for name in ("material", "body"):
        known = getattr(snapshots[0], f"{name}_names")
        width = max(map(len, known), default=1)
        names[name] = np.full(len(ids), "", f"<U{max(1, width)}")
    for snapshot in snapshots:
        if len(np.unique(snapshot["id"])) != len(snapshot["id"]):
            raise UserError(f"{snapshot.path}: two particles have one id")
        place = np.searchsorted(ids, snapshot["id"])
        for name, values in names.items():
            values[place] = snapshot[name]
    return ids, names


def _check_memory(numbers: int) -> None:
    needed, free = COPIES * 8 * numbers, available_bytes()
    if needed > SHARE * free:
        raise ResourceError(
            f"that would take {needed / 1e9:.3g} GB, and {free / 1e9:.3g} GB are free: name fewer"
            " fields (fields=...) or times (times=...), or read one snapshot after the other"
        )


def _width(field: ParticleField, dim: int) -> int:
    return {"vector": dim, "symmetric": 9}.get(field.shape, 1)


def _empty(field: ParticleField, times: int, particles: int, dim: int) -> np.ndarray:
    """What there is where a particle is not: nan, or -1 of whole numbers."""
    tail: dict[str, tuple[int, ...]] = {"vector": (dim,), "symmetric": (3, 3)}
    shape = (times, particles, *tail.get(field.shape, ()))
    if np.dtype(field.dtype).kind == "f":
        return np.full(shape, np.nan)
    return np.full(shape, -1, field.dtype)


def _dims(field: ParticleField) -> list[str]:
    more = {"vector": ["axis"], "symmetric": ["row", "column"]}
    return ["time", "particle", *more.get(field.shape, [])]


def _axes(found: xr.Dataset, dim: int) -> dict[str, list[str]]:
    known = {"axis": AXES[:dim], "row": AXES, "column": AXES}
    return {name: labels for name, labels in known.items() if name in found.dims}


def _attributes(field: ParticleField, dim: int) -> dict[str, Any]:
    found: dict[str, Any] = attributes(field.doc, field.unit_in(dim))
    return found if np.dtype(field.dtype).kind == "f" else found | {"missing_value": -1}


def _components(field: ParticleField, dim: int) -> Iterator[tuple[str, int]]:
    """Names of the numbers of a field, and where they stand in a row of it."""
    if field.shape == "vector":
        yield from ((f"{field.key}_{AXES[axis]}", axis) for axis in range(dim))
    elif field.shape == "symmetric":
        yield from ((f"{field.key}_{AXES[a]}{AXES[b]}", 3 * a + b) for a, b in SYMMETRIC)
    else:
        yield field.key, 0


def _columns(
    snapshot: Snapshot, fields: Sequence[ParticleField], dim: int
) -> dict[str, np.ndarray]:
    count = len(snapshot["id"])
    found = {"time": np.full(count, snapshot.time)}
    found |= {name: snapshot[name] for name in OF_PARTICLE}
    for field in fields:
        values = snapshot[field.key].reshape(count, _width(field, dim))
        found |= {name: values[:, column] for name, column in _components(field, dim)}
    return found
