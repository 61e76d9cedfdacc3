"""Curves over time: columns of the history, and what windows show of the flow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...errors import UserError
from ...record.reader import Run
from ...record.units import unit_in
from ...scenario.tables.figure import SeriesFigure
from ...util.spelling import suggestion
from ..layout import chart_grid, figure_legend

MASSES = ("mass_asked", "mass_entered", "mass_inside", "mass_left")
KINDS = {  # part of a column's name: what it measures, unit in 3-D
    "energy": ("energy", "J"),
    "dissipation": ("energy", "J"),
    "work": ("energy", "J"),
    "mass": ("mass", "kg"),
    "momentum": ("momentum", "kg m/s"),
    "dt": ("time step", "s"),
}
STYLES = ("-", "--", "-.", ":")  # curves that lie on each other can still be told apart


def draw_series(run: Run, name: str, table: SeriesFigure) -> Figure:
    """The figure [figure.NAME] of columns of the history."""
    return draw_history(run, table.columns, table.title)


def draw_history(run: Run, columns: Sequence[str], title: str) -> Figure:
    """Columns of the history over time; raises UserError for a column that is not there."""
    for column in columns:
        if column not in run.history.columns:
            known = suggestion(column, run.history.columns)
            raise UserError(f"{run.directory}: no history column {column!r}{known}")
    figure, grid = chart_grid(1, 1, (7.0, 3.2), title)
    curves = {column.replace("_", " "): run.history[column] for column in columns}
    draw_curves(grid[0, 0], run.history["time"], curves)
    figure_legend(figure, grid.flat)
    grid[0, 0].set_ylabel(axis_label(columns, run.scenario["dim"]))
    grid[0, 0].set_xlabel("time (s)")
    return figure


def draw_curves(axes: Axes, times: np.ndarray, curves: Mapping[str, np.ndarray]) -> None:
    """Named curves over time, for a legend of the figure; a curve called "" is not named."""
    for number, (name, values) in enumerate(curves.items(), start=len(axes.lines)):
        draw_curve(axes, times, values, name, number)
    axes.grid(alpha=0.3)


def draw_curve(axes: Axes, times: np.ndarray, values: np.ndarray, name: str, number: int) -> None:
    """One of them, in the colour and style of a number."""
    style, color = STYLES[number % len(STYLES)], f"C{number}" if name else "black"
    axes.plot(times, values, style, color=color, label=name, linewidth=1.5)


def axis_label(columns: Sequence[str], dim: int) -> str:
    """What the columns measure, when they all measure the same, and its unit."""
    kinds = {KINDS.get(next((part for part in KINDS if part in column), "")) for column in columns}
    kind = kinds.pop() if len(kinds) == 1 else None
    if kind is None:
        return ""
    name, unit = kind
    return f"{name} ({unit_in(unit, dim)})"
