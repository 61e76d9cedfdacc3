"""The picture of a case: its curves at every resolution, and how its errors fall."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures.layout import chart_grid
from .judging import Result

PANEL = (5.0, 3.6)  # inches
LINES = ("-", "--", "-.", ":")
MARKS = ("o", "s", "^", "v", "d", "x", "+", "*")


def draw_result(result: Result) -> Figure:
    """The picture of a case that has run."""
    panels = 1 + (len(result.outcomes) > 1)
    figure, grid = chart_grid(1, panels, PANEL, result.case.title, sharex=False)
    _draw_curves(grid[0, 0], result)
    if panels > 1:
        _draw_errors(grid[0, 1], result)
    return figure


def _draw_curves(axes: Axes, result: Result) -> None:
    outcomes = list(result.outcomes.items())
    for number, (size, outcome) in enumerate(outcomes):
        for curve in outcome.curves:
            label = f"{curve.label} {result.case.across} = {size:g}".strip()
            style = f"C{number}." if curve.points else f"C{number}{LINES[number % len(LINES)]}"
            axes.plot(curve.x, curve.y, style, label=label, linewidth=1.2, markersize=3)
    for number, curve in enumerate(outcomes[-1][1].reference):
        style = f"k{MARKS[number % len(MARKS)]}" if curve.points else "k-"
        axes.plot(
            curve.x, curve.y, style, label=curve.label, linewidth=0.8, markersize=3.5,
            markerfacecolor="none",
        )  # fmt: skip
    axes.set_xlabel(result.case.axes[0])
    axes.set_ylabel(result.case.axes[1])
    axes.grid(alpha=0.3)
    if axes.get_lines():
        axes.legend(fontsize="x-small", frameon=False)


def _draw_errors(axes: Axes, result: Result) -> None:
    """|error| of each quantity against resolution, with lines of first and second order."""
    sizes, drawn = np.array(list(result.outcomes)), []
    for number, criterion in enumerate(result.case.criteria):
        values = [outcome.values[criterion.quantity] for outcome in result.outcomes.values()]
        errors = np.abs([value.error for value in values])
        if np.isfinite(errors).all() and errors.all():
            mark = MARKS[number % len(MARKS)]
            axes.loglog(sizes, errors, f"{mark}-", label=criterion.quantity, markersize=4)
            drawn += [errors[-1]]
    for order, style in ((1, "k:"), (2, "k--")) if drawn else ():
        line = min(drawn) * (sizes[-1] / sizes) ** order
        axes.loglog(sizes, line, style, label=f"order {order}", linewidth=0.8)
    axes.set_xlabel(result.case.across)
    axes.set_ylabel("size of the error")
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    if drawn:
        axes.legend(fontsize="x-small", frameon=False)
