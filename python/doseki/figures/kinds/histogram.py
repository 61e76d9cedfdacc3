"""Fig. 5 of the paper: how fast the grains in a window are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...measure import numbers as measure
from ...measure.census.census import SpeedDraws, draw_speeds
from ...measure.moments import Moment
from ...measure.views import View, named_window, select, whole_space
from ...record.reader import Run, Snapshot
from ...scenario.tables.figure import HistogramFigure
from ..layout import SMALL, chart_grid, figure_legend, moment_text, say_empty
from ..nothing import NothingToDrawError
from .moments import chosen

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
    moments = chosen(run, table, view)
    title = table.title or view.title
    what = SpeedHistogram(view, table.material, table.bin_width, table.sample, title)
    return draw_rows(run, moments, what)


def draw_rows(run: Run, moments: Sequence[Moment], what: SpeedHistogram) -> Figure:
    """A row for each moment: all grains in the window; random samples of them as in the paper.

    Moments at which there are none have no row. Raises NothingToDrawError where none has one.
    """
    name = what.material or "particles"
    found = [(moment, what.speeds(run[moment.index])) for moment in moments]
    found = [(moment, speeds) for moment, speeds in found if len(speeds)]
    if not found:
        raise NothingToDrawError(f"there is no {name} at these times")
    figure, grid = chart_grid(len(found), 2, (4.2, 3.0), what.title)
    for row, (moment, speeds) in zip(grid, found, strict=True):
        drawn = draw_speeds(speeds, what.bin_width, what.sample)
        time = moment_text(run, moment)
        draw_speed_row(row, drawn, f"{name} per {what.bin_width:g} m/s", f"{time}: ")
    figure_legend(figure, grid[0])
    return figure


def draw_speed_row(row: Sequence[Axes], drawn: SpeedDraws, name: str, when: str = "") -> None:
    """All speeds, counted as `name`, beside what random samples of them look like."""
    every, sampled = row
    for axes in row:
        axes.set_xlabel("speed (m/s)")
    every.set_ylabel(name)
    if not len(drawn.speeds):
        for axes in row:
            say_empty(axes, "nothing came by")
        return
    every.stairs(drawn.counts, drawn.edges, fill=True, color=ALL_COLOUR, alpha=0.85)
    mean = float(drawn.speeds.mean())
    every.axvline(mean, color="black", label="mean", linewidth=1, linestyle="--")
    every.set_title(f"{when}mean {mean:.2f} m/s, all {len(drawn.speeds)}", **SMALL)
    _draw_samples(sampled, drawn)


def _draw_samples(axes: Axes, drawn: SpeedDraws) -> None:
    axes.stairs(drawn.mean, drawn.edges, fill=True, color=SAMPLE_COLOUR, label="mean of samples")
    some = drawn.mean > 0
    centres = (drawn.edges[1:] + drawn.edges[:-1])[some] / 2
    # A bin that few samples reach has its mean above 95 % of them.
    band = np.clip([(drawn.mean - drawn.low)[some], (drawn.high - drawn.mean)[some]], 0.0, None)
    axes.errorbar(
        centres, drawn.mean[some], band, fmt="none", color="black", capsize=2,
        linewidth=1, label="5 % to 95 % of samples",
    )  # fmt: skip
    axes.set_title(f"random samples of {drawn.size}", **SMALL)
    axes.set_ylabel(f"number of {drawn.size}")
