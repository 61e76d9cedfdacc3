"""Curves of what a gauge read: over time, or profiles over height at some times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .errors import UserError
from .figure_series import draw_curves
from .layout import chart_grid
from .loading import GaugeRecord, Run
from .nearest import suggestion

PROFILES = 4  # drawn, where no times are given


def draw_gauge(
    run: Run, name: str | None, columns: Sequence[str], times: Sequence[float], title: str
) -> Figure:
    """One panel for each column (default: all) of a gauge; raises UserError if it is not there."""
    if name not in run.gauges:
        raise UserError(f"{run.directory}: no gauge {name!r}{suggestion(str(name), run.gauges)}")
    record = run.gauges[name]
    is_profile = "fraction" in record
    own = [column for column in record if column not in ("time", "height", "fraction")]
    shown = list(columns) or own or ["height"]
    figure, grid = chart_grid(len(shown), 1, (7.0, 2.4), title or name)
    for axes, column in zip(grid[:, 0], shown, strict=True):
        label = f"{column.replace('_', ' ')} ({record.units[column]})"
        if is_profile:
            for time, rows in _profiles(record, times):
                axes.plot(record[column][rows], record["height"][rows], label=f"{time:.3g} s")
            axes.legend(
                loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize="small"
            )
            axes.grid(alpha=0.3)
            axes.set_xlabel(label)
            axes.set_ylabel("height (m)")
        else:
            draw_curves(axes, record["time"], {"": record[column]})
            axes.set_ylabel(label)
    if not is_profile:
        grid[-1, 0].set_xlabel("time (s)")
    return figure


def _profiles(record: GaugeRecord, times: Sequence[float]) -> list[tuple[float, np.ndarray]]:
    """Time and rows of the samples nearest to `times`, or of some spread over the run."""
    sampled = np.unique(record["time"])
    if not len(sampled):
        return []
    wanted = times or np.linspace(sampled[0], sampled[-1], PROFILES)
    chosen = sorted({float(sampled[np.argmin(np.abs(sampled - time))]) for time in wanted})
    return [(time, record["time"] == time) for time in chosen]
