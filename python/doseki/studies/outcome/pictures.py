"""The pictures of a study: what its table shows, and its bands."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ...errors import DosekiError
from ...figures.maps.drawing import draw_map
from ...figures.saving import Drawn
from ...figures.studies.bands import draw_band
from ...figures.studies.responses import Column, grid_images, parallel_coordinates, responses
from ...measure.maps.quantities import MapQuantity
from ..plan.file import Plan
from ..reading.bands import CurveBand, MapBand, SeriesBand
from ..reading.observations import ObservedSeries
from ..reading.observed_files import read_series
from ..reading.results import MAPS
from .bands import CurvePercentiles, curve_percentiles, map_percentiles, write_curve, write_maps
from .table import Table


class Pictures:
    """Draws into DIR/figures and DIR/bands; what cannot be drawn is told and costs nothing else."""

    def __init__(self, table: Table, directory: Path) -> None:
        """Of a table, in the folder of its study."""
        self._table, self._directory = table, directory
        self._drawn = Drawn()
        self.files = self._drawn.pictures  # and tables of bands among them
        self._notes: list[str] = []

    @property
    def notes(self) -> list[str]:
        """What there is no picture of, and why, and what is wrong with pictures."""
        return [*self._notes, *self._drawn.notes, *self._drawn.remarks]

    def draw(self) -> None:
        """All of them."""
        inputs, outputs = inputs_of(self._table), outputs_of(self._table)
        title = self._table.plan.top.title
        colour = outputs[0] if outputs else Column("run", np.arange(len(self._table.done)) * 1.0)
        self._save("parallel", lambda: parallel_coordinates([*inputs, *outputs], colour, title))
        self._save("responses", lambda: responses(inputs, outputs, title))
        sample = self._table.plan.sample
        if sample is not None and sample.kind == "grid" and len(inputs) == 2:
            self._save("grid", lambda: grid_images(inputs, outputs, title))
        for name, band in self._table.plan.bands.items():
            try:
                if isinstance(band, CurveBand):
                    self._draw_curve(name, band)
                elif isinstance(band, MapBand):
                    self._draw_map(name, band)
            except DosekiError as error:
                self._notes.append(f"bands.{name}: {error}")

    def _draw_curve(self, name: str, band: CurveBand) -> None:
        found = curve_percentiles(name, band, self._table)
        path = self._directory / "bands" / f"{name}.csv"
        write_curve(path, found, band)
        self.files.append(path)
        observed = _observed(self._table.plan, band, found)
        title = f"{name}: {len(found.runs)} runs"
        self._save(
            f"band-{name}",
            lambda: draw_band(
                found.x, found.values, found.runs, band.percent, (found.x_label, found.label),
                title, observed,
            ),
        )  # fmt: skip

    def _draw_map(self, name: str, band: MapBand) -> None:
        found = map_percentiles(band, self._table)
        self.files += write_maps(self._directory / "bands", name, found, band)
        quantity = MAPS[band.map]
        for percent, raster in zip(band.percent, found.percentiles, strict=True):
            title = f"{name}: not exceeded by {percent:g} % of runs"
            self._save(
                f"band-{name}-p{percent:g}",
                partial(draw_map, quantity, raster, found.bed, title, found.structures),
            )
        exceeded = found.exceeded
        if exceeded is not None:
            words = f"share of runs above {band.exceed:g} {quantity.unit}"
            share = MapQuantity(f"above-{band.exceed:g}", "-", words)
            self._save(
                f"band-{name}-above",
                lambda: draw_map(
                    share, exceeded, found.bed, f"{name}: {quantity.label}", found.structures
                ),
            )

    def _save(self, name: str, draw: Callable[[], Figure]) -> None:
        self._drawn.add(self._directory / "figures" / f"{name}.png", draw)


def inputs_of(table: Table) -> list[Column]:
    """What varies, of the runs that were done."""
    return [
        Column(
            _label(axis.name, axis.own_unit), table.values(k), axis.log,
            () if axis.is_numeric else tuple(str(choice) for choice in axis.choices),
        )
        for k, axis in enumerate(table.plan.axes)
    ]  # fmt: skip


def _label(name: str, unit: str) -> str:
    """Name and unit at an axis, as those of all figures."""
    return f"{name} ({unit})" if unit and unit != "1" else name


def outputs_of(table: Table) -> list[Column]:
    """The score where there is one, and the results."""
    units = table.plan.units()
    found = [Column("score", table.scores())] if table.is_scored else []
    results = table.plan.results
    return found + [Column(_label(name, units[name]), table.results(name)) for name in results]


def _observed(
    plan: Plan, band: CurveBand, found: CurvePercentiles
) -> tuple[np.ndarray, np.ndarray] | None:
    """The observation of the same column of the same gauge."""
    if not isinstance(band, SeriesBand):
        return None
    for each in plan.observations.values():
        if not isinstance(each, ObservedSeries):
            continue
        if (each.gauge, each.column) == (band.gauge, band.column):
            column, unit = each.column_and_unit(plan.scenario)
            table = read_series(plan.folder / each.file, column, unit)
            inside = (table["time"] >= found.x[0]) & (table["time"] <= found.x[-1])
            return table["time"][inside], table["value"][inside]
    return None
