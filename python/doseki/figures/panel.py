"""The particles of one snapshot on axes that are given, with their key beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from ..measure.views import View
from ..record.reader import Run, Snapshot
from .colouring import colouring
from .dots import dots, draw_particles, extent_of, outside_text
from .layout import SMALL, Extent, name_axes, time_text
from .space.ground import draw_ground
from .text import plain_text

BAR = (1.02, 0.0, 0.025, 1.0)  # a colour bar, in widths and heights of the axes
WIDTH, LEAST, MOST = 8.0, 2.0, 7.0  # inches of a figure: width, least and greatest height
KEY = 1.8  # inches of its width that the key and the labels take


@dataclass(frozen=True)
class _BesideAxes:
    """Room for a key on the axes' own figure, whatever else is there."""

    figure: Figure | SubFigure

    def beside(self, axes: Axes) -> Axes:
        """Narrow axes for a colour bar, which go with `axes`."""
        return axes.inset_axes(BAR)


def panel_size(extent: Extent) -> tuple[float, float]:
    """Width and height, inches, of a figure of one panel that shows `extent`."""
    left, right, bottom, top = extent
    height = (WIDTH - KEY) * (top - bottom) / (right - left) + 0.9
    return WIDTH, min(max(height, LEAST), MOST)


def panel_extent(snapshot: Snapshot, view: View) -> Extent:
    """What a panel of the particles in a view shows, m."""
    return extent_of([snapshot], view)


def draw_panel(
    axes: Axes, run: Run, snapshot: Snapshot, colour: str, view: View, material: str | None = None
) -> None:
    """Draw the particles true to scale, coloured by a quantity; in 3-D those of a thin slice.

    Raises UserError for an unknown quantity.
    """
    with plain_text():
        extent = panel_extent(snapshot, view)
        colours = colouring(run, [snapshot], colour, view)
        shown = dots(snapshot, view, material=material)
        draw_ground(axes, run, view, extent)
        draw_particles(axes, snapshot, shown, colours, extent)
        name_axes(axes, snapshot.dim, view.rotate)
        title = time_text(snapshot.time, float(run.times[-1])) + _slice_text(snapshot, shown.index)
        axes.set_title(title + outside_text(snapshot, view, shown, extent), **SMALL)
        colours.add_key(_BesideAxes(axes.figure), axes)


def _slice_text(snapshot: Snapshot, shown: np.ndarray) -> str:
    """Where the slice is, in 3-D."""
    if snapshot.dim == 2 or not len(shown):
        return ""
    return f", slice at y = {snapshot['position'][shown, 1].mean():.3g} m"
