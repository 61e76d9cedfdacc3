"""Many runs on one picture: parallel coordinates, and results against the values that vary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from ..layout import chart_grid
from ..nothing import NothingToDrawError

COLOURS = "viridis"
MOST_PANELS = 8  # on one side of a figure
LOG_RATIO = 20.0  # of scores, from which their colours are by decades
PANEL = (3.2, 2.6)  # inches
SAME = 0.1  # of a score that all runs have, by which the scale of colours goes beyond it
LEAST_FOR_TREND = 6  # different values; a curve through fewer says nothing


@dataclass(frozen=True)
class Column:
    """Numbers (n,) of n runs; `ticks` names them where they stand for words."""

    label: str
    values: np.ndarray
    log: bool = False
    ticks: Sequence[str] = ()


def parallel_coordinates(columns: Sequence[Column], colour: Column, title: str) -> Figure:
    """A line for each run through all columns; the runs with the least colour on top.

    Raises:
        NothingToDrawError: there are less than two columns or runs.

    """
    if len(columns) < 2 or len(colour.values) < 2:
        raise NothingToDrawError("parallel coordinates need two columns and two runs")
    width = max(7.0, 1.5 * len(columns))
    figure, panels = chart_grid(1, 1, (width, 3.6), title)
    axes = panels[0, 0]
    scaled = np.array([_scaled(column) for column in columns])
    norm, order = _norm(colour.values), _worst_first(colour.values)
    mapping = ScalarMappable(norm, COLOURS)
    for k in order:
        known = np.isfinite(colour.values[k])
        axes.plot(
            scaled[:, k], color=mapping.to_rgba(colour.values[k]) if known else "0.8",
            linewidth=1.2, alpha=0.85,
        )  # fmt: skip
    axes.set_xlim(-0.15, len(columns) - 0.6)
    axes.set_ylim(-0.04, 1.04)
    axes.set_yticks([])
    axes.set_xticks(range(len(columns)), [column.label for column in columns], fontsize="small")
    for side in ("left", "right", "top", "bottom"):
        axes.spines[side].set_visible(False)
    for place, column in enumerate(columns):
        _scale(axes, place, column)
    bar = figure.colorbar(mapping, ax=axes, shrink=0.9, pad=0.02)
    bar.set_label(colour.label, fontsize="small")
    bar.ax.tick_params(labelsize="x-small")
    return figure


def responses(inputs: Sequence[Column], outputs: Sequence[Column], title: str) -> Figure:
    """Each result against each value, with the quadratic that fits best where it means something.

    Raises:
        NothingToDrawError: there is no result, or no run.

    """
    if not outputs or not len(outputs[0].values):
        raise NothingToDrawError("no result of any run")
    inputs, outputs = inputs[:MOST_PANELS], outputs[:MOST_PANELS]
    figure, panels = chart_grid(len(outputs), len(inputs), PANEL, title, sharex="col")
    for row, output in enumerate(outputs):
        for column, each in enumerate(inputs):
            _response(panels[row, column], each, output)
            if column == 0:
                panels[row, 0].set_ylabel(output.label, fontsize="small")
            if row == len(outputs) - 1:
                panels[row, column].set_xlabel(each.label, fontsize="small")
    return figure


def grid_images(inputs: Sequence[Column], outputs: Sequence[Column], title: str) -> Figure:
    """Results over the two values of a grid, an image each.

    Raises:
        NothingToDrawError: there are not two values, or no result.

    """
    if len(inputs) != 2 or not outputs or not len(outputs[0].values):
        raise NothingToDrawError("images are of grids of two values")
    outputs = outputs[:MOST_PANELS]
    across = min(len(outputs), 3)
    down = -(-len(outputs) // across)
    figure, panels = chart_grid(down, across, (3.8, 3.0), title, sharex=False)
    for axes, output in zip(panels.ravel(), outputs, strict=False):
        _image(figure, axes, inputs, output)
    for axes in panels.ravel()[len(outputs) :]:
        axes.set_axis_off()
    return figure


def _image(figure: Figure, axes: Axes, inputs: Sequence[Column], output: Column) -> None:
    (x, i), (y, j) = (np.unique(each.values, return_inverse=True) for each in inputs)
    cells = np.full((len(y), len(x)), np.nan)
    cells[j, i] = output.values
    image = axes.imshow(cells, origin="lower", aspect="auto", cmap=COLOURS)
    figure.colorbar(image, ax=axes, shrink=0.9)
    for each, values, axis in zip(inputs, (x, y), (axes.xaxis, axes.yaxis), strict=True):
        shown = np.unique(np.linspace(0, len(values) - 1, min(len(values), 6)).round().astype(int))
        axis.set_ticks(list(shown), [_named(each, values[k]) for k in shown], fontsize="x-small")
        axis.set_label_text(each.label, fontsize="small")
    axes.set_title(output.label, fontsize="small", loc="left")
    axes.set_facecolor("0.85")  # runs that have none


def _response(axes: Axes, each: Column, output: Column) -> None:
    known = np.isfinite(each.values) & np.isfinite(output.values)
    x, y = each.values[known], output.values[known]
    axes.plot(x, y, "o", markersize=3.5, alpha=0.8)
    if each.log:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(10, subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_locator(NullLocator())
    elif each.ticks:
        axes.set_xticks(range(len(each.ticks)), list(each.ticks), fontsize="x-small")
        axes.margins(x=0.3)
    else:
        axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.tick_params(labelsize="x-small")
    if len(np.unique(x)) >= LEAST_FOR_TREND and not each.ticks:
        t = np.log(x) if each.log else x
        line = np.linspace(t.min(), t.max(), 60)
        fit = np.polynomial.Polynomial.fit(t, y, 2)
        axes.plot(np.exp(line) if each.log else line, fit(line), "-", color="0.4", linewidth=1)


def _scaled(column: Column) -> np.ndarray:
    """Values from 0 to 1; in the middle where all are the same."""
    values = np.log(column.values) if column.log else column.values
    known = values[np.isfinite(values)]
    if not len(known) or np.ptp(known) == 0:
        return np.where(np.isfinite(values), 0.5, np.nan)
    return (values - known.min()) / np.ptp(known)


def _scale(axes: Axes, place: int, column: Column) -> None:
    """A vertical line with numbers, the scale of a column."""
    axes.axvline(place, color="0.3", linewidth=0.8, zorder=3)
    known = column.values[np.isfinite(column.values)]
    if not len(known):
        return
    marked = np.unique(known) if column.ticks else _marks(column, known)
    places = _scaled(Column("", np.concatenate([known, marked]), column.log))[len(known) :]
    for value, height in zip(marked, places, strict=True):
        axes.text(
            place + 0.03, height, _named(column, value), fontsize="x-small", va="center", zorder=4,
            bbox={"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 0.6},
        )  # fmt: skip


def _marks(column: Column, known: np.ndarray) -> np.ndarray:
    """The ends of a scale, and its middle."""
    low, high = known.min(), known.max()
    if low == high:
        return np.array([low])
    middle = np.sqrt(low * high) if column.log else 0.5 * (low + high)
    return np.array([low, middle, high])


def _named(column: Column, value: float) -> str:
    return column.ticks[round(value)] if column.ticks else f"{value:.4g}"


def _norm(values: np.ndarray) -> Normalize:
    known = values[np.isfinite(values)]
    if not len(known):
        return Normalize(0, 1)
    low, high = float(known.min()), float(known.max())
    if low > 0 and high > LOG_RATIO * low:
        return LogNorm(low, high)
    room = 0.0 if high > low else SAME * abs(low) or 1.0
    return Normalize(low - room, high + room)


def _worst_first(values: np.ndarray) -> np.ndarray:
    return np.argsort(-np.nan_to_num(values, nan=np.inf), kind="stable")
