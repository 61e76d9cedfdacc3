"""A band of percentiles along a line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ..layout import chart_grid
from ..nothing import NothingToDrawError


def draw_band(
    x: np.ndarray,
    band: np.ndarray,
    runs: np.ndarray,
    percent: Sequence[float],
    labels: tuple[str, str],
    title: str,
    observed: tuple[np.ndarray, np.ndarray] | None = None,
) -> Figure:
    """Percentiles (3, n) over x (n,), the runs (runs, n) behind, and what was observed.

    Raises:
        NothingToDrawError: no run has a value.

    """
    if not np.isfinite(band).any():
        raise NothingToDrawError("no run has a value")
    figure, panels = chart_grid(1, 1, (7.0, 3.2), title)
    axes = panels[0, 0]
    axes.plot(x, runs.T, color="0.75", linewidth=0.5, zorder=1)
    low, middle, high = (f"{p:g}" for p in percent)
    axes.fill_between(
        x, band[0], band[2], color="tab:blue", alpha=0.3, label=f"{low} to {high} %", zorder=2
    )
    axes.plot(x, band[1], color="tab:blue", linewidth=1.8, label=f"{middle} %", zorder=3)
    if observed is not None:
        axes.plot(*observed, "k.", markersize=4, label="observed", zorder=4)
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    axes.margins(x=0)
    axes.legend(frameon=False, fontsize="small")
    return figure
