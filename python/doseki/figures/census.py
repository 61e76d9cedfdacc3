"""Pictures of a census: classes and passed mass over time, speeds, the outline of the deposit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from ..measure.census.census import CLASSES, Census, SpeedDraws
from ..measure.grading import Grading
from ..record.units import unit_in
from .kinds.histogram import draw_speed_row
from .kinds.series import draw_curves
from .layout import chart_grid, figure_legend
from .nothing import NothingToDrawError

MOST_CURVES = 6  # of a grading over time
COLOURS = ("#bdbdbd", "#fdae61", "#3182bd", "#74c476", "#756bb1", "#636363")  # of CLASSES


def draw_classes(census: Census) -> Figure:
    """Shares of the load in each class, one above the other, over time."""
    if not census.load_mass:
        raise NothingToDrawError("there is no load, since nothing was loose at the start")
    figure, grid = chart_grid(1, 1, (7.0, 3.2), "Grains by class")
    shares = [census.share(census.mass_of(kind)) for kind in range(len(CLASSES))]
    axes = grid[0, 0]
    axes.stackplot(census.times, shares, labels=CLASSES, colors=COLOURS)
    axes.set(xlabel="time (s)", ylabel="share of the load", ylim=(0, 1))
    axes.margins(x=0)
    axes.legend(
        loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False,
        fontsize="small", reverse=True,
    )  # fmt: skip
    return figure


def draw_speed_histogram(drawn: SpeedDraws, where: str) -> Figure:
    """All speeds, and what random samples of them look like."""
    figure, grid = chart_grid(1, 2, (4.2, 3.0), f"Speed of the grains, {where}")
    draw_speed_row(grid[0], drawn, "grains")
    figure_legend(figure, grid.flat)
    return figure


def draw_passed(census: Census, sections: Sequence[float], dim: int) -> Figure:
    """Mass that has crossed each section, over time."""
    figure, grid = chart_grid(1, 1, (7.0, 3.0), "Grains that have passed")
    curves = {}
    for section in sections:
        name = f"x = {section:.12g} m"
        if census.load_mass:
            curves[name] = census.passed(section)
        if census.off_structures[-1]:
            curves[f"{name}, off structures"] = census.passed(section, load=False)
    draw_curves(grid[0, 0], census.times, curves)
    figure_legend(figure, grid.flat)
    unit, load = unit_in("kg", dim), census.load_mass
    of_load = f"; load: {load:.4g}" if load else ""
    grid[0, 0].set(xlabel="time (s)", ylabel=f"passed ({unit}{of_load})")
    return figure


def draw_deposit(outline: np.ndarray, dim: int) -> Figure:
    """The outline, in the axes of the window."""
    figure, grid = chart_grid(1, 1, (7.0, 3.0), "Outline of the deposit")
    closed = outline if dim == 2 else np.concatenate([outline, outline[:1]])
    grid[0, 0].plot(closed[:, 0], closed[:, 1], color=COLOURS[-1])
    grid[0, 0].set(xlabel="x' (m)", ylabel="height (m)" if dim == 2 else "y' (m)")
    grid[0, 0].grid(alpha=0.3)
    return figure


def _when_they_change(gradings: Mapping[float, Grading]) -> list[float]:
    """The first time, and those at which the curve is another one than before."""
    times = sorted(gradings)
    found = times[:1]
    for time in times[1:]:
        if not np.array_equal(gradings[time].size, gradings[found[-1]].size):
            found.append(time)
    return found


def draw_grading(gradings: Mapping[float, Grading]) -> Figure:
    """Shares of the mass that are finer than a size, at a few times when anything is loose."""
    gradings = {time: grading for time, grading in gradings.items() if len(grading.size)}
    if not gradings:
        raise NothingToDrawError("whatever came off had left by the next snapshot")
    figure, grid = chart_grid(1, 1, (7.0, 3.4), "Grading of what is loose")
    times = _when_they_change(gradings)
    axes = grid[0, 0]
    shown = np.unique(np.linspace(0, len(times) - 1, MOST_CURVES).round().astype(int))
    largest = max(float(grading.size.max()) for grading in gradings.values())
    smallest = min(float(grading.size.min()) for grading in gradings.values())
    for number, k in enumerate(shown):
        grading = gradings[times[k]]
        size = np.concatenate([[0.8 * smallest], grading.size, [1.25 * largest]])
        finer = 100 * np.concatenate([[0.0], grading.finer, [1.0]])
        colour = colormaps["viridis_r"](0.1 + 0.9 * number / max(len(shown) - 1, 1))
        axes.step(size, finer, where="post", color=colour, label=f"{times[k]:.3g} s")
    axes.set(
        xscale="log", xlim=(0.8 * smallest, 1.25 * largest), ylim=(0, 102),
        xlabel="size (m)", ylabel="mass finer (%)",
    )  # fmt: skip
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda size, _: f"{size:g}"))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.grid(alpha=0.3)
    figure_legend(figure, grid.flat)
    return figure
