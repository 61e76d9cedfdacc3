"""Where the panels of a figure stand, in inches, so that nothing overlaps or is squashed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

DPI = 150
WIDTH, HEIGHT = 8.0, 12.0  # inches for all panels of a row, of a column
LEFT, BOTTOM, ABOVE, TITLE = 0.95, 0.55, 0.35, 0.35  # inches around the panels
GAP, KEY_SLOT = 0.25, 1.6  # inches to the right of a panel

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


def name_axes(axes: Axes, dim: int, rotate: float) -> None:
    """Name the axes of a panel where they have numbers; a prime marks turned axes."""
    prime = "'" if rotate else ""
    if axes.xaxis.get_tick_params()["labelbottom"]:
        axes.set_xlabel(f"x{prime} (m)")
    if axes.yaxis.get_tick_params()["labelleft"]:
        axes.set_ylabel(f"{'xyz'[dim - 1]}{prime} (m)")


def chart_grid(
    rows: int, columns: int, panel: tuple[float, float], title: str, sharex: bool = True
) -> tuple[Figure, np.ndarray]:
    """A figure of rows x columns charts of `panel` = (width, height) inches: (figure, axes)."""
    figure = _figure(columns * panel[0] + 1.5, rows * panel[1] + 0.6)
    figure.set_layout_engine("constrained")
    figure.suptitle(title, fontsize="medium", wrap=True)
    return figure, figure.subplots(rows, columns, squeeze=False, sharex=sharex)


def _figure(width: float, height: float) -> Figure:
    figure = Figure(figsize=(width, height), dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def time_text(time: float, longest: float) -> str:
    """`t = 2.5 ms` or `t = 2.50 s`, by the length of the run."""
    return f"t = {1e3 * time:.3g} ms" if longest < 0.1 else f"t = {time:.2f} s"
