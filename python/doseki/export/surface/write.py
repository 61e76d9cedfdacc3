"""`doseki export DIR --surface`: surfaces of what flows as files."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from ...errors import UserError
from ...measure.views import fluid_names
from ...record.fields import FIELD_BY_KEY
from ...record.reader import Run, Snapshot
from ...util.files import write_whole, write_whole_text
from ...util.spelling import suggestion
from ..folder import Entries, pvd, series, whole_folder
from ..polydata import PolyData, in_space
from ..triangles import near_origin, write_ply, write_stl
from .contour import Surface, contour
from .fraction import Grid, blocks
from .particles import (
    Matter,
    chosen_materials,
    kernel_of,
    matter,
    spacing_of,
)
from .values import interpolated

FORMATS = ("vtp", "ply", "stl")
UNITS = {
    "Velocity": FIELD_BY_KEY["velocity"].unit,
    "Speed": FIELD_BY_KEY["velocity"].unit,
    "Pressure": FIELD_BY_KEY["pressure"].unit,
}


@dataclass(frozen=True)
class SurfaceOptions:
    """What is asked for; `cell` None: half a spacing, no `materials`: what flows, no `times`: all.

    Lengths in m, times in s.
    """

    format: str = "vtp"
    cell: float | None = None
    level: float = 0.5
    materials: Sequence[str] = ()
    times: Sequence[float] = ()


@dataclass(frozen=True)
class Made:
    """A surface with fields at its points, and the volume of its particles, m3 (2-D: m2)."""

    surface: Surface
    fields: dict[str, np.ndarray]
    particles: float


def export_surface(run: Run, options: SurfaceOptions, out: Path | None = None) -> list[str]:
    """Write a file for each material and snapshot, an index and a table; lines that say what.

    They go to `out` (default: DIR/surface), which must not exist or be empty.

    Raises:
        UserError: an option does not fit the run, or a file cannot be written.

    """
    _check(run, options)
    snapshots = _snapshots(run, options.times)
    names = chosen_materials(run, options.materials)
    origin = _origin(snapshots, names, options.cell or run.scenario["dp"])
    folder = out if out is not None else run.directory / "surface"
    lines = []
    with whole_folder(folder) as unfinished:
        for name in names:
            lines += _export_material(run, snapshots, name, options, origin, unfinished)
    return [f"{folder}/{line}" for line in lines]


def _check(run: Run, options: SurfaceOptions) -> None:
    if options.format not in FORMATS:
        raise UserError(
            f"--format {options.format}: not a format of surfaces"
            f"{suggestion(options.format, FORMATS)}; they are {', '.join(FORMATS)}"
        )
    if run.scenario["dim"] == 2 and options.format != "vtp":
        raise UserError(
            f"--format {options.format}: holds triangles, and the surface of a 2-D run is a line; "
            "use --format vtp"
        )
    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot yet")


def _snapshots(run: Run, times: Sequence[float]) -> list[Snapshot]:
    if not times:
        return list(run)
    found = {s.path.stem: s for s in (run.at(time, nearest=True) for time in times)}
    return [found[stem] for stem in sorted(found)]


def _origin(snapshots: Sequence[Snapshot], materials: Sequence[str], cell: float) -> np.ndarray:
    """What is taken off places in files of few digits, (3,), m: one of all files, or surfaces of
    two times would not lie where they do.
    """
    for snapshot in snapshots:
        drawn = np.isin(snapshot["material"], materials)
        if drawn.any():
            return near_origin(in_space(snapshot["position"][drawn]), cell)
    return np.zeros(3)


def _export_material(
    run: Run,
    snapshots: Sequence[Snapshot],
    name: str,
    options: SurfaceOptions,
    origin: np.ndarray,
    folder: Path,
) -> list[str]:
    cell = options.cell or 0.5 * spacing_of(run, name)
    grid = Grid(cell, options.level, kernel_of(run), tuple(run.periods()))
    flowing = fluid_names(run)
    stem = "".join(c if c.isalnum() or c in "-_" else "_" for c in name)
    entries, rows, lost = [], [], 0
    for snapshot in snapshots:
        found = matter(snapshot, name, grid.kernel, flowing)
        made = surface_of(found, grid)
        file = folder / f"{stem}_{snapshot.path.stem}.{options.format}"
        write_whole(file, partial(_write, made, snapshot, name, grid, origin))
        entries.append((snapshot.time, file.name))
        rows.append([snapshot.time, made.surface.area, made.surface.volume, made.particles])
        lost += found.lost
    index = _write_index(folder, stem, options.format, entries)
    _write_table(folder / f"{stem}.csv", snapshots[0].dim, rows)
    lines = [f"{index}: {len(entries)} times, cells of {cell:.3g} m", f"{stem}.csv"]
    if lost:
        lines[0] += f"; {lost} particles that are nowhere or have no volume are left out"
    return lines


def surface_of(found: Matter, grid: Grid) -> Made:
    """The surface of the matter of a snapshot."""
    fluid = found.fluid
    surface = contour(blocks(found.cloud, grid), grid.cell, found.cloud.dim)
    fields = interpolated(surface.points, fluid, found.fields, grid.kernel)
    return Made(surface, fields, float(fluid.volume.sum()))


def _write(
    made: Made, snapshot: Snapshot, name: str, grid: Grid, origin: np.ndarray, path: Path
) -> None:
    """The file `path` is to become, by the ending of its name."""
    surface, about = made.surface, f"surface of {name} at {snapshot.time!r} s"
    mesh = surface.points, surface.faces
    kind = path.name.removesuffix(".part").rpartition(".")[2]
    if kind == "stl":
        write_stl(path, mesh, origin, about)
    elif kind == "ply":
        comments = [
            about, "x y z [m]", *(f"{k} [{UNITS[_field(k)]}]" for k in _scalars(made.fields)),
            f"cell {grid.cell!r} m, level {grid.level!r}",
        ]  # fmt: skip
        write_ply(path, mesh, origin, _scalars(made.fields), comments)
    else:
        _polydata(made, snapshot, name, grid).write(path)


def _field(scalar: str) -> str:
    return {"speed": "Speed", "pressure": "Pressure"}.get(scalar, "Velocity")


def _scalars(fields: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The names by which programs that read PLY know scalars."""
    velocity = fields["Velocity"]
    parts = {f"velocity_{axis}": velocity[:, k] for k, axis in enumerate("xyz")}
    return {"speed": fields["Speed"], "pressure": fields["Pressure"], **parts}


def _polydata(made: Made, snapshot: Snapshot, name: str, grid: Grid) -> PolyData:
    surface = made.surface
    return PolyData(
        surface.points,
        lines=surface.loops() if surface.dim == 2 else (),
        polys=surface.faces if surface.dim == 3 else (),
        fields={k: in_space(v) if v.ndim > 1 else v for k, v in made.fields.items()},
        units=UNITS,
        strings={
            "Material": [name],
            "Surface": [f"level {grid.level!r} of the share of {name}, cells of {grid.cell!r} m"],
        },
        time=snapshot.time,
    )


def _write_index(folder: Path, stem: str, kind: str, entries: Entries) -> str:
    name, text = (f"{stem}.pvd", pvd) if kind == "vtp" else (f"{stem}.{kind}.series", series)
    write_whole_text(folder / name, text(entries))
    return name


def _write_table(path: Path, dim: int, rows: Sequence[Sequence[float]]) -> None:
    of = "length [m]", "area [m2]", "area of particles [m2]"
    if dim == 3:
        of = "area [m2]", "volume [m3]", "volume of particles [m3]"
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([["time [s]", *of], *rows])
    write_whole_text(path, text.getvalue())
