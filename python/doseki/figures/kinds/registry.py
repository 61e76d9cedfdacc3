"""How the figures of each kind are drawn: one line each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure as Picture

from ...record.reader import Run
from ...scenario.tables.figure import (
    DepthFigure,
    Figure,
    GaugeFigure,
    HistogramFigure,
    LoadFigure,
    SeriesFigure,
    SnapshotFigure,
)
from .gauge import draw_gauge
from .histogram import draw_histogram
from .load import draw_load
from .series import draw_series
from .snapshot import draw_snapshots
from .xt import draw_depth

DRAWN_BY: dict[type[Figure], Callable[[Run, str, Any], Picture]] = {
    SnapshotFigure: draw_snapshots,
    HistogramFigure: draw_histogram,
    SeriesFigure: draw_series,
    DepthFigure: draw_depth,
    GaugeFigure: draw_gauge,
    LoadFigure: draw_load,
}


def draw(run: Run, name: str, table: Figure) -> Picture:
    """The figure [figure.NAME] of a run, as its kind is drawn."""
    return DRAWN_BY[type(table)](run, name, table)
