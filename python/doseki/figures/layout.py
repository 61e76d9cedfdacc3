"""Where the panels of a figure stand, in inches, so that nothing overlaps or is squashed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..measure.moments import Moment
from ..record.reader import Run
from .text import TITLE, wrapped

DPI = 150
WIDTH, HEIGHT = 8.0, 12.0  # inches for all panels of a row, of a column
LEFT, BOTTOM, ABOVE = 0.95, 0.55, 0.35  # inches around the panels
FIRST_LINE, LINE, EDGE = 0.35, 0.2, 0.15  # inches of a title: first line, others, at its sides
GAP, KEY_SLOT = 0.25, 1.6  # inches to the right of a panel
VIEWS_WIDTH, VIEW_GAP = 8.5, 0.8  # inches for views in space, and below each of them
VIEW_TOP = 0.25  # inches of the gap that are above a view
FLAT_VIEWS = 9.0  # views that are longer than so many heights stand below each other
FULL = (-5, 9)  # powers of ten between which lengths, m, have no exponent
BAR_SHARE = 0.2  # of the width: a scale bar is no longer

SMALL: dict[str, Any] = {"fontsize": "small", "loc": "left"}  # titles of panels

Extent = tuple[float, float, float, float]  # left, right, bottom, top in m


class PanelGrid:
    """A figure of panels with the proportions of `extent`, and a slot for a key beside some.

    Everything is placed in inches, so that panels of equal units never leave gaps or overlap.
    """

    def __init__(self, rows: int, key_after: Sequence[bool], extent: Extent, title: str) -> None:
        """`key_after` tells for each column whether a slot for a key stands to its right."""
        ratio = (extent[3] - extent[2]) / (extent[1] - extent[0])
        widest = WIDTH / len(key_after)
        self._rows = rows
        self._panel_height = min(max(widest * ratio, 0.8), 5.0, HEIGHT / rows)
        self._panel_width = min(widest, max(self._panel_height / ratio, 1.5))
        self._right_of = [KEY_SLOT if key else GAP for key in key_after]
        width = LEFT + len(key_after) * self._panel_width + sum(self._right_of)
        height = BOTTOM + rows * (self._panel_height + ABOVE)
        self.figure, _ = _titled_figure(width, height, title)

    def panel(self, row: int, column: int) -> Axes:
        """The axes at (row, column), counted from the top left."""
        left = LEFT + column * self._panel_width + sum(self._right_of[:column])
        bottom = BOTTOM + (self._rows - 1 - row) * (self._panel_height + ABOVE)
        axes = self._add(left, bottom, self._panel_width)
        lengths_in_full(axes)
        axes.xaxis.set_major_locator(MaxNLocator(max(3, int(1.3 * self._panel_width))))
        axes.yaxis.set_major_locator(MaxNLocator(max(3, int(2.5 * self._panel_height))))
        axes.tick_params(labelbottom=row == self._rows - 1, labelleft=column == 0)
        return axes

    def beside(self, axes: Axes) -> Axes:
        """Narrow axes for a colour bar to the right of a panel."""
        size = self.figure.get_size_inches()
        box = axes.get_position()
        return self._add(box.x1 * size[0] + 0.12, box.y0 * size[1], 0.15)

    def _add(self, left: float, bottom: float, width: float) -> Axes:
        across, up = self.figure.get_size_inches()
        box = (left / across, bottom / up, width / across, self._panel_height / up)
        return self.figure.add_axes(box)


class ViewRows:
    """Rows of three views of one space, each with the proportions of its extent, and keys.

    The first view stands left of the other two, or above them where they are long and flat.
    """

    def __init__(self, rows: int, extents: Sequence[Extent], title: str) -> None:
        """Extents of the three views."""
        wide = np.array([e[1] - e[0] for e in extents])
        high = np.array([e[3] - e[2] for e in extents])
        self._flat = bool(wide.sum() > FLAT_VIEWS * high.max())
        columns = 1 if self._flat else 3
        self.key_beside = columns - 1  # the panel that keys stand beside
        scale = min(VIEWS_WIDTH / (wide.max() if self._flat else wide.sum()), 5.0 / high.max())
        self._sizes = np.stack([wide, high], axis=1) * scale
        inner = (high.sum() if self._flat else high.max()) * scale
        self._row = inner + (4 - columns) * VIEW_GAP
        across = (wide.max() if self._flat else wide.sum()) * scale + columns * LEFT
        self.figure, self._title = _titled_figure(across + KEY_SLOT, rows * self._row, title)

    def row(self, number: int) -> list[Axes]:
        """The axes of a row: slanting view, plan, section."""
        top = self.figure.get_size_inches()[1] - self._title - number * self._row - VIEW_TOP
        left, found = LEFT, []
        for width, height in self._sizes:
            found.append(self._add(left, top - height, width, height))
            if self._flat:
                top -= height + VIEW_GAP
            else:
                left += width + LEFT
        for axes, (width, height) in zip(found, self._sizes, strict=True):
            lengths_in_full(axes)
            axes.xaxis.set_major_locator(MaxNLocator(max(2, int(1.3 * width))))
            axes.yaxis.set_major_locator(MaxNLocator(max(2, int(2.0 * height))))
        return found

    def beside(self, axes: Axes) -> Axes:
        """Narrow axes for a colour bar to the right of a panel."""
        across, up = self.figure.get_size_inches()
        box = axes.get_position()
        return self._add(box.x1 * across + 0.12, box.y0 * up, 0.15, box.height * up)

    def _add(self, left: float, bottom: float, width: float, height: float) -> Axes:
        across, up = self.figure.get_size_inches()
        return self.figure.add_axes((left / across, bottom / up, width / across, height / up))


def scale_bar(axes: Axes) -> None:
    """A bar of a round length, m, in the lower left corner of axes of equal units."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    length = nice_length(BAR_SHARE * (right - left))
    axes.plot([left, left + length], [bottom, bottom], "k-", linewidth=3, gid="scale bar")
    axes.text(left, bottom + 0.02 * (top - bottom), f"{length:g} m", fontsize="small")


def nice_length(longest: float) -> float:
    """The longest of 1, 2, 5, 10, 20 ... (and 0.5, 0.2 ...) that is no longer than `longest`."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(power * step for step in (1.0, 2.0, 5.0) if power * step <= longest * (1 + 1e-9))


def lengths_in_full(axes: Axes, axis: Literal["both", "x", "y"] = "both") -> None:
    """Numbers at axes as they are, with no offset: coordinates of maps have seven digits."""
    axes.ticklabel_format(axis=axis, useOffset=False, style="sci", scilimits=FULL)


def name_axes(axes: Axes, dim: int, rotate: float) -> None:
    """Name the axes of a panel where they have numbers; a prime marks turned axes."""
    prime = "'" if rotate else ""
    if axes.xaxis.get_tick_params()["labelbottom"]:
        axes.set_xlabel(f"x{prime} (m)")
    if axes.yaxis.get_tick_params()["labelleft"]:
        axes.set_ylabel(f"{'xyz'[dim - 1]}{prime} (m)")


def chart_grid(
    rows: int,
    columns: int,
    panel: tuple[float, float],
    title: str,
    sharex: bool | Literal["col"] = True,
) -> tuple[Figure, np.ndarray]:
    """A figure of rows x columns charts of `panel` = (width, height) inches: (figure, axes).

    `sharex` says whether all have the same x axis, or those of each column.
    """
    width = columns * panel[0] + 1.5
    lines = wrapped(title, width - 2 * EDGE)
    figure = _figure(width, rows * panel[1] + 0.6 + LINE * lines.count("\n"))
    figure.set_layout_engine("constrained")
    figure.suptitle(lines, fontsize=TITLE)
    return figure, figure.subplots(rows, columns, squeeze=False, sharex=sharex)


def _titled_figure(width: float, height: float, title: str) -> tuple[Figure, float]:
    """A figure with a title over `height` inches of panels, and the inches that the title takes."""
    lines = wrapped(title, width - 2 * EDGE)
    room = FIRST_LINE + LINE * lines.count("\n") if lines else 0.1
    figure = _figure(width, height + room)
    figure.suptitle(lines, fontsize=TITLE, y=1 - 0.1 / (height + room), va="top")
    return figure, room


def _figure(width: float, height: float) -> Figure:
    figure = Figure(figsize=(width, height), dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def figure_legend(figure: Figure, panels: Iterable[Axes]) -> None:
    """One legend for all panels: each name once, to the right of the figure."""
    handles: dict[str, Any] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if handles:
        figure.legend(
            list(handles.values()), list(handles), loc="outside right upper", frameon=False,
            fontsize="small",
        )  # fmt: skip


def name_of_curves(axes: Axes, name: str, height: float) -> None:
    """What a panel of `height` inches shows, beside it, in as many lines as there is room for."""
    axes.set_ylabel(wrapped(name, 0.85 * height), fontsize=TITLE)


def say_empty(axes: Axes, why: str = "no data", times: np.ndarray | None = None) -> None:
    """A panel that shows nothing says so; numbers at its axes would look like measurements.

    `times` are those that were looked at: they stay on the axis that it shares with others.
    """
    which: Literal["y", "both"] = "both" if times is None else "y"
    axes.tick_params(axis=which, which="both", length=0, labelleft=False, labelbottom=False)
    axes.grid(visible=False)
    axes.text(0.5, 0.5, why, transform=axes.transAxes, ha="center", va="center", color="0.4")
    if times is not None and len(times):
        axes.update_datalim([(times.min(), 0.0), (times.max(), 0.0)], updatey=False)
        axes.autoscale_view(scaley=False)


def say_where_empty(axes: Axes, times: np.ndarray | None = None) -> None:
    """The same for a panel of curves of which none has a value."""
    if not any(np.isfinite(np.asarray(line.get_ydata())).any() for line in axes.lines):
        say_empty(axes, times=times)


def moment_text(run: Run, moment: Moment) -> str:
    """The time of a moment, and what happened then."""
    time = time_text(float(run.times[moment.index]), float(run.times[-1]))
    return f"{time}, {moment.name}" if moment.name else time


def time_text(time: float, longest: float) -> str:
    """`t = 2.50 s`, of a short run with more digits: in seconds, as curves over time are."""
    digits = 2 if not 0 < longest < 0.1 else 2 - math.floor(math.log10(longest))
    return f"t = {time:.{digits}f} s"
