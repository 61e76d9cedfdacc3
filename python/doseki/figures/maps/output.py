"""What `doseki maps` leaves in DIR/maps: rasters, pictures, a profile, and the run-out."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ...errors import UserError
from ...geodata.crs import not_compared_text, why_not_compared
from ...geodata.features import read_on_map
from ...geodata.grid import Raster
from ...measure.maps.files import read_maps, write_maps
from ...measure.maps.grid import MapSettings, few_particles, map_grid
from ...measure.maps.peaks import beside_deposit
from ...measure.maps.profile import COLUMNS, along_path, beside_map, path_lines
from ...measure.maps.quantities import QUANTITIES
from ...measure.maps.runout import runout, runout_lines
from ...measure.maps.snapshots import flowing_in, maps_from_snapshots
from ...record.reader import Run, load
from ...record.writer import jsonable
from ...util.files import write_whole_text
from ...util.foreign import REMEDY
from ..saving import Drawn
from .drawing import draw_map, draw_profile
from .structures import Structures


@dataclass(frozen=True)
class MapOptions:
    """What of the maps is asked for."""

    cell: float | None = None  # m
    extent: Sequence[float] | None = None  # west, south, east, north, m
    path: str | None = None  # of a profile: a file of a line, or "x,y x,y ..."


def write_pictures(
    directory: str | Path, options: MapOptions, drawn: Drawn | None = None
) -> list[str]:
    """Draw the maps of the run in `directory`; returns lines that tell of them.

    What became of each picture is put into `drawn`.

    A run with [maps] has kept them; those of others are made of its snapshots.

    Raises:
        UserError: there is no run, no terrain and no grid, or the path is no path.

    """
    run = load(directory)
    told_of = _told_beside(run)  # first: what is damaged is told at once
    maps, bed, said = _maps(run, options)
    profile = None
    if options.path is not None:
        path, doubts = _path(options.path, bed.crs)
        profile = along_path(maps, bed, path)
        said += [*doubts, *beside_map(bed, path)]
    drawn = Drawn() if drawn is None else drawn
    for name, make in _makers(run, maps, bed):
        drawn.add(run.folder.maps / f"{name}.png", make)
    if profile is not None:
        drawn.pictures.append(_write_profile(run, profile))
        title = str(run.scenario.get("title", ""))
        drawn.add(run.folder.maps / "profile.png", lambda: draw_profile(profile, title))
    settings = MapSettings.of(run.scenario.get("maps"), run.scenario["dp"])
    beside = told_of if _keeps_maps(run) else _beside(run, bed, settings)
    found = replace(runout(maps, bed, settings.speed_deposit), beside_deposit=beside)
    told = [*runout_lines(found, settings), *(path_lines(profile) if profile is not None else ())]
    write_whole_text(run.folder.maps / "runout.json", json.dumps(jsonable(asdict(found))) + "\n")
    return [*said, *map(str, drawn.pictures), *told, *(f"warning: {t}" for t in drawn.remarks)]


def _maps(run: Run, options: MapOptions) -> tuple[dict[str, Raster], Raster, list[str]]:
    """The maps, the bed on their cells, and how they were made."""
    if run.scenario["dim"] != 3:
        raise UserError(f"{run.directory}: a 2-D run has no map")
    table = run.scenario.get("maps")
    settings = MapSettings.of(table, run.scenario["dp"])
    kept = read_maps(run.folder) if table is not None else {}
    if kept:
        if options.cell is not None or options.extent is not None:
            raise UserError(
                f"{run.directory}: the run has kept its maps with the cells of its scenario; "
                "--cell and --extent are for runs without [maps]"
            )
        return kept, map_grid(run.folder, settings), []
    settings = replace(
        settings,
        cell=settings.cell if options.cell is None else options.cell,
        extent=settings.extent if options.extent is None else options.extent,
        named="--",
    )
    bed = map_grid(run.folder, settings)
    maps = maps_from_snapshots(run, bed, settings)
    write_maps(run.folder, maps, settings, float(run.times[-1]))
    said = [
        f"from {len(run)} snapshots: what peaked between them is missed; a table [maps] in the "
        "scenario keeps maps while a run goes on"
    ]
    if warning := few_particles(bed, settings.dp, settings.named):
        said.append(f"warning: {warning}")
    return maps, bed, said


def _keeps_maps(run: Run) -> bool:
    """Whether a run keeps maps while it goes on."""
    return run.scenario.get("maps") is not None


def _told_beside(run: Run) -> Mapping[str, float] | None:
    """What is not in the deposit of a run that kept maps, as it told."""
    said = run.summary.get("runout") or {}
    if not isinstance(said, dict):
        raise UserError(f"{run.folder.summary}: is damaged: runout must be a table; {REMEDY}")
    return said.get("beside_deposit") if _keeps_maps(run) else None


def _beside(run: Run, bed: Raster, settings: MapSettings) -> Mapping[str, float]:
    """What is not in the deposit by the last snapshot."""
    state = flowing_in(run, run[-1])
    return beside_deposit(bed, state, settings.speed_deposit, settings.dry_below)


def map_makers(run: Run) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """The name of each map that a run has kept, and what draws it or raises NothingToDrawError."""
    if not _keeps_maps(run) or not (maps := read_maps(run.folder)):
        return
    bed = map_grid(run.folder, MapSettings.of(run.scenario["maps"], run.scenario["dp"]))
    yield from _makers(run, maps, bed)


def _makers(
    run: Run, maps: Mapping[str, Raster], bed: Raster
) -> Iterator[tuple[str, Callable[[], Figure]]]:
    title = str(run.scenario.get("title", ""))
    structures = Structures.of(run)
    for quantity in QUANTITIES:
        yield (
            quantity.name,
            partial(draw_map, quantity, maps[quantity.name], bed, title, structures),
        )


LONGEST_NAME = 255  # of a file


def _path(given: str, crs: str | None) -> tuple[np.ndarray, list[str]]:
    """Points (n, 2) of a path on the map of `crs`: of the line in a file, or as they are given.

    And what is doubtful about the file.
    """
    try:
        rows = [[float(number) for number in point.split(",")] for point in given.split()]
        points = np.array(rows, dtype=np.float64)
    except ValueError:
        points = np.empty(0)
    if points.ndim == 2 and points.shape[1] == 2 and np.isfinite(points).all():
        return points, []
    if len(given) > LONGEST_NAME or not Path(given).exists():
        raise UserError(
            f'--path {given[:80]}: neither a file nor points such as "460000,5200000 460100,'
            '5200000"'
        )
    found = read_on_map(given, crs)
    lines, why = found.lines, why_not_compared(found.crs, crs)
    if len(lines) != 1:
        raise UserError(f"{given}: holds {len(lines)} lines; a profile goes along one")
    return lines[0].vertices, [f"warning: {not_compared_text(given, why)}"] if why else []


def _write_profile(run: Run, profile: Mapping[str, np.ndarray]) -> Path:
    """The table of a profile."""
    header = ",".join(f"{name} [{unit}]" for name, unit in COLUMNS.items())
    rows = np.column_stack([profile[name] for name in COLUMNS])
    text = "\n".join([header, *(",".join(map(repr, row)) for row in rows.tolist())])
    table = run.folder.maps / "profile.csv"
    write_whole_text(table, text + "\n")
    return table
