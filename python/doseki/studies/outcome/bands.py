"""Percentiles over the runs of a study, along lines and on maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from ...errors import UserError
from ...figures.maps.structures import Structures
from ...geodata.grid import Raster
from ...geodata.raster import write_raster
from ...measure.maps.quantities import ARRIVAL_TIME, PEAK_DEPTH
from ...record.reader import Run, load
from ...util.files import clear_errors, write_whole_text
from ...util.foreign import read_text
from ..reading.bands import Band, CurveBand, MapBand, read_curve
from .table import Entry, Table

MAX_BYTES = 50_000_000
LEAST_RUNS = 3


@dataclass(frozen=True)
class CurvePercentiles:
    """Percentiles (3, n) at places or times (n,); every run on the same ones."""

    x: np.ndarray
    values: np.ndarray
    runs: np.ndarray  # (runs, n)
    x_label: str
    label: str


@dataclass(frozen=True)
class MapPercentiles:
    """Rasters of percentiles, lowest first, and of the share of runs above a level.

    `structures` are those that stand alike on the bed of every run.
    """

    percentiles: list[Raster]
    exceeded: Raster | None
    bed: Raster
    structures: Structures | None


def counted(band: Band, table: Table) -> list[Entry]:
    """The runs that a band is of; raises UserError where there are too few for one."""
    chosen = table.done
    if band.max_score is not None:
        chosen = [entry for entry in chosen if entry.row.score <= band.max_score]
    if len(chosen) < LEAST_RUNS:
        raise UserError(f"{len(chosen)} runs count; a band needs {LEAST_RUNS}")
    return chosen


def curve_percentiles(name: str, band: CurveBand, table: Table) -> CurvePercentiles:
    """Percentiles of curves of the runs, on the places of the first; raises UserError for none."""
    places = [entry.place for entry in counted(band, table)]
    texts = [read_text(place.curve(name), MAX_BYTES) for place in places]
    curves = [read_curve(str(p.curve(name)), t) for p, t in zip(places, texts, strict=True)]
    x = curves[0][0]
    runs = np.array([np.interp(x, *curve, left=np.nan, right=np.nan) for curve in curves])
    labels = texts[0].partition("\n")[0].split(",", 1)
    values = percentiles(runs, band.percent)
    return CurvePercentiles(x, values, runs, labels[0], labels[-1])


def percentiles(values: np.ndarray, percent: Sequence[float]) -> np.ndarray:
    """Percentiles over the first axis, linear between runs; nan counts for nothing."""
    found = np.full((len(percent), *values.shape[1:]), np.nan)
    known = np.isfinite(values).any(axis=0)
    found[:, known] = np.nanpercentile(values[:, known], percent, axis=0)
    return found


def map_percentiles(band: MapBand, table: Table) -> MapPercentiles:
    """Percentiles of a map, cell by cell, where dry runs count as dry.

    A cell that less runs than a percentile reached has no arrival time there. Raises UserError
    where runs have maps on different cells.
    """
    runs = [load(entry.place.record.path) for entry in counted(band, table)]
    rasters = [band.raster(run) for run in runs]
    first = rasters[0]
    for run, raster in zip(runs, rasters, strict=True):
        if not raster.same_grid(first):
            raise UserError(f"{run.directory}: its map has other cells than those of other runs")
    stack = np.array([raster.values for raster in rasters])
    of_times = band.map == ARRIVAL_TIME.name
    never = np.inf if of_times else 0.0
    outside = np.isnan(stack).all(axis=0) & (not of_times)
    stack = np.where(np.isnan(stack), never, stack)
    # An order statistic for times: nothing lies between a time and never.
    method: Literal["inverted_cdf", "linear"] = "inverted_cdf" if of_times else "linear"
    found = np.array([np.percentile(stack, p, axis=0, method=method) for p in band.percent])
    found = np.where(np.isfinite(found) & ~outside, found, np.nan)
    exceeded = None
    if band.exceed is not None:
        share = np.mean(stack > band.exceed, axis=0)
        unknown = _beside(band, runs) if of_times else outside
        exceeded = _with(first, np.where(unknown, np.nan, share))
    ground = runs[0].ground
    bed = ground if isinstance(ground, Raster) else _with(first, np.full(first.shape, np.nan))
    if not bed.same_grid(first):
        bed = _resampled(bed, first)
    percent = [_with(first, each) for each in found]
    return MapPercentiles(percent, exceeded, bed, Structures.of_all(runs))


def _beside(band: MapBand, runs: Sequence[Run]) -> np.ndarray:
    """Mask (rows, cols) of cells without a terrain, which arrival times do not tell."""
    depth = band.model_copy(update={"map": PEAK_DEPTH.name})
    return np.asarray(np.isnan([depth.raster(run).values for run in runs]).all(axis=0))


def write_curve(path: Path, found: CurvePercentiles, band: Band) -> None:
    """The percentiles of a curve as CSV."""
    header = ",".join([found.x_label, *(f"{p:g} %" for p in band.percent)])
    rows = zip(found.x, *found.values, strict=True)
    lines = [",".join("" if np.isnan(cell) else f"{cell:.9g}" for cell in row) for row in rows]
    _make(path.parent)
    write_whole_text(path, "\n".join([header, *lines]) + "\n")


def write_maps(folder: Path, name: str, found: MapPercentiles, band: MapBand) -> list[Path]:
    """The percentiles as rasters, and the probability; returns the files."""
    _make(folder)
    rasters = {f"{name}-p{p:g}": r for p, r in zip(band.percent, found.percentiles, strict=True)}
    if found.exceeded is not None:
        rasters[f"{name}-above-{band.exceed:g}"] = found.exceeded
    files = []
    for stem, raster in rasters.items():
        files.append(folder / f"{stem}{raster.suffix}")
        write_raster(files[-1], raster, {"quantity": band.map, "of": "runs of a study"})
    return files


def _make(folder: Path) -> None:
    with clear_errors(folder):
        folder.mkdir(exist_ok=True)


def _with(raster: Raster, values: np.ndarray) -> Raster:
    return raster.with_values(values)


def _resampled(bed: Raster, cells: Raster) -> Raster:
    """The bed on the cells of a map."""
    return cells.with_values(bed.sampled(*np.meshgrid(cells.x, cells.y)))
