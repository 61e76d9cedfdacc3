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

DPI = 150
WIDTH, HEIGHT = 8.0, 12.0  # inches for all panels of a row, of a column
LEFT, BOTTOM, ABOVE, TITLE = 0.95, 0.55, 0.35, 0.35  # inches around the panels
GAP, KEY_SLOT = 0.25, 1.6  # inches to the right of a panel
VIEWS_WIDTH, VIEW_GAP = 11.0, 0.8  # inches for views in space, and below each of them
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
        height = BOTTOM + rows * (self._panel_height + ABOVE) + (TITLE if title else 0.0)
        self.figure = _figure(width, height)
        self.figure.suptitle(title, fontsize="medium", wrap=True, y=1 - 0.1 / height, va="top")

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
        self._rows, self._title = rows, TITLE if title else 0.1
        across = (wide.max() if self._flat else wide.sum()) * scale + columns * LEFT
        height = rows * self._row + self._title
        self.figure = _figure(across + KEY_SLOT, height)
        self.figure.suptitle(title, fontsize="medium", wrap=True, y=1 - 0.1 / height, va="top")

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
    figure = _figure(columns * panel[0] + 1.5, rows * panel[1] + 0.6)
    figure.set_layout_engine("constrained")
    figure.suptitle(title, fontsize="medium", wrap=True)
    return figure, figure.subplots(rows, columns, squeeze=False, sharex=sharex)


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


def moment_text(run: Run, moment: Moment) -> str:
    """The time of a moment, and what happened then."""
    time = time_text(float(run.times[moment.index]), float(run.times[-1]))
    return f"{time}, {moment.name}" if moment.name else time


def time_text(time: float, longest: float) -> str:
    """`t = 2.5 ms` or `t = 2.50 s`, by the length of the run."""
    return f"t = {1e3 * time:.3g} ms" if longest < 0.1 else f"t = {time:.2f} s"
