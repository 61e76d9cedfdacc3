"""Curves of what a gauge read: over time, or profiles over height at some times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...errors import UserError
from ...measure.views import gauge_record, tables
from ...record.reader import GaugeRecord, Run
from ...scenario.gauges.gauge import Gauge
from ...scenario.tables.figure import GaugeFigure
from ...util.spelling import suggestion
from ..layout import chart_grid, figure_legend, lengths_in_full, name_of_curves, say_where_empty
from .series import draw_curves

PROFILES = 4  # drawn, where no times are given
NAMED = 12  # curves at most that have a name
WIDE = 5.0  # inches of a panel
TALL, LOW, MANY = 2.4, 1.4, 6  # inches of its height; of that of one of more than so many


def draw_gauge(run: Run, name: str, table: GaugeFigure) -> Figure:
    """The figure [figure.NAME]: one panel for each column (default: all) of a gauge.

    Raises UserError if the gauge has left no record.
    """
    gauges = tables(run, "gauge", Gauge)
    if table.gauge not in gauges:
        known = suggestion(table.gauge, gauges)
        raise UserError(f"{run.directory}: no gauge {table.gauge!r}{known}")
    record, gauge = gauge_record(run, table.gauge), gauges[table.gauge]
    shown = table.columns or gauge.curves(run.scenario["dim"])
    height = TALL if len(shown) <= MANY else LOW
    figure, grid = chart_grid(len(shown), 1, (WIDE, height), table.title or table.gauge)
    for axes, column in zip(grid[:, 0], shown, strict=True):
        label = f"{column.replace('_', ' ')} ({record.units[column]})"
        if gauge.is_profile:
            _draw_profiles(axes, record, column, table.times)
            axes.set_xlabel(label)
            lengths_in_full(axes, "y")
            say_where_empty(axes)
        else:
            _draw_over_time(axes, record, column, gauge.series)
            name_of_curves(axes, label, height)
            say_where_empty(axes, record["time"])
            if record.units[column] == "m":
                lengths_in_full(axes, "y")
    if not gauge.is_profile:
        grid[-1, 0].set_xlabel("time (s)")
    figure_legend(figure, grid[:1, 0])
    return figure


def _draw_over_time(axes: Axes, record: GaugeRecord, column: str, series: str | None) -> None:
    """One curve, or one for each value of the column `series`."""
    if series is None:
        draw_curves(axes, record["time"], {"": record[column]})
        return
    each = [(value, record[series] == value) for value in np.unique(record[series])]
    for value, rows in each:
        name = f"{series} {value:g}" if 1 < len(each) <= NAMED else ""
        draw_curves(axes, record["time"][rows], {name: record[column][rows]})


def _draw_profiles(axes: Axes, record: GaugeRecord, column: str, times: Sequence[float]) -> None:
    for time, rows in _profiles(record, times):
        axes.plot(record[column][rows], record["height"][rows], label=f"{time:.3g} s")
    axes.grid(alpha=0.3)
    axes.set_ylabel("height (m)")


def _profiles(record: GaugeRecord, times: Sequence[float]) -> list[tuple[float, np.ndarray]]:
    """Time and rows of the samples nearest to `times`, or of some spread over the run."""
    sampled = np.unique(record["time"])
    if not len(sampled):
        return []
    wanted = times or np.linspace(sampled[0], sampled[-1], PROFILES)
    chosen = sorted({float(sampled[np.argmin(np.abs(sampled - time))]) for time in wanted})
    return [(time, record["time"] == time) for time in chosen]
