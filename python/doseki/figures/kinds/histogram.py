"""Fig. 5 of the paper: how fast the grains in a window are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...measure import numbers as measure
from ...measure.census import SpeedDraws, draw_speeds
from ...measure.views import View, named_window, select, whole_space
from ...record.reader import Run, Snapshot
from ...scenario.tables.figure import HistogramFigure
from ..layout import chart_grid, time_text
from .moments import caption, chosen

ALL_COLOUR, SAMPLE_COLOUR = "#d7301f", "#8c8c8c"


@dataclass(frozen=True)
class SpeedHistogram:
    """What is counted and how: bins of `bin_width` m/s, samples of `sample`."""

    view: View
    material: str | None = None
    bin_width: float = 0.1
    sample: int = 30
    title: str = ""

    @property
    def _materials(self) -> set[str] | None:
        return None if self.material is None else {self.material}

    def speeds(self, snapshot: Snapshot) -> np.ndarray:
        """Speeds of what is counted, m/s: particles, or the bodies that they are parts of."""
        chosen = select(snapshot, self.view, self._materials)
        if not (bodies := snapshot.grains):
            return measure.speed(snapshot["velocity"][chosen])
        grain = snapshot["grain"]
        single = snapshot["velocity"][chosen & (grain < 0)]
        anywhere = select(snapshot, whole_space(snapshot.dim), self._materials)
        whole = np.unique(grain[anywhere & (grain >= 0)])
        whole = whole[self.view.contains(bodies["position"][whole])]
        return measure.speed(np.concatenate([single, bodies["velocity"][whole]]))


def draw_histogram(run: Run, name: str, table: HistogramFigure) -> Figure:
    """The figure [figure.NAME] of speeds at some moments."""
    view = named_window(run, table.window)
    snapshots = chosen(run, table, view)
    title = caption(run, table, view, snapshots)
    what = SpeedHistogram(view, table.material, table.bin_width, table.sample, title)
    return draw_rows(run, snapshots, what)


def draw_rows(run: Run, snapshots: Sequence[Snapshot], what: SpeedHistogram) -> Figure:
    """A row for each snapshot: all grains in the window; random samples of them as in the paper."""
    figure, grid = chart_grid(len(snapshots), 2, (4.2, 3.0), what.title)
    for row, snapshot in zip(grid, snapshots, strict=True):
        drawn = draw_speeds(what.speeds(snapshot), what.bin_width, what.sample)
        time = time_text(snapshot.time, run.times[-1])
        name = what.material or "particles"
        if len(drawn.speeds) == 0:
            row[0].text(0.0, 0.5, f"{time}: no {name} in the window")
            row[0].set_axis_off()
            row[1].set_axis_off()
            continue
        draw_speed_row(row, drawn, f"{name} per {what.bin_width:g} m/s", f"{time}: ")
    return figure


def draw_speed_row(row: Sequence[Axes], drawn: SpeedDraws, name: str, when: str = "") -> None:
    """All speeds, counted as `name`, beside what random samples of them look like."""
    every, sampled = row
    every.stairs(drawn.counts, drawn.edges, fill=True, color=ALL_COLOUR, alpha=0.85)
    if len(drawn.speeds):
        mean = float(drawn.speeds.mean())
        label = f"mean {mean:.2f} m/s"
        every.axvline(mean, color="black", label=label, linewidth=1, linestyle="--")
        every.legend(fontsize="small", frameon=False)
    every.set_title(f"{when}all {len(drawn.speeds)}", fontsize="small", loc="left")
    every.set_ylabel(name)
    _draw_samples(sampled, drawn)
    for axes in row:
        axes.set_xlabel("speed (m/s)")


def _draw_samples(axes: Axes, drawn: SpeedDraws) -> None:
    axes.stairs(drawn.mean, drawn.edges, fill=True, color=SAMPLE_COLOUR, label="mean of them")
    some = drawn.mean > 0
    centres = (drawn.edges[1:] + drawn.edges[:-1])[some] / 2
    # A bin that few samples reach has its mean above 95 % of them.
    band = np.clip([(drawn.mean - drawn.low)[some], (drawn.high - drawn.mean)[some]], 0.0, None)
    axes.errorbar(
        centres, drawn.mean[some], band, fmt="none", color="black", capsize=2,
        linewidth=1, label="5 % to 95 % of them",
    )  # fmt: skip
    axes.set_title(f"random samples of {drawn.size}", fontsize="small", loc="left")
    axes.set_ylabel(f"number of {drawn.size}")
    axes.legend(fontsize="small", frameon=False)
