"""Fig. 5 of the paper: how fast the grains in a window are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import measure
from .layout import chart_grid, time_text
from .loading import Run, Snapshot
from .views import View, select

ALL_COLOUR, SAMPLE_COLOUR = "#d7301f", "#8c8c8c"


@dataclass(frozen=True)
class SpeedHistogram:
    """Which particles are counted and how: bins of `bin_width` m/s, samples of `sample`."""

    view: View
    material: str | None = None
    bin_width: float = 0.1
    sample: int = 30
    title: str = ""

    def speeds(self, snapshot: Snapshot) -> np.ndarray:
        """Speeds of the particles that are counted, m/s."""
        materials = None if self.material is None else {self.material}
        return measure.speed(snapshot["velocity"][select(snapshot, self.view, materials)])


def draw_histogram(run: Run, snapshots: Sequence[Snapshot], what: SpeedHistogram) -> Figure:
    """A row for each snapshot: all grains in the window; random samples of them as in the paper."""
    figure, grid = chart_grid(len(snapshots), 2, (4.2, 3.0), what.title)
    for row, snapshot in zip(grid, snapshots, strict=True):
        speeds = what.speeds(snapshot)
        time = time_text(snapshot.time, run.times[-1])
        name = what.material or "particles"
        if len(speeds) == 0:
            row[0].text(0.0, 0.5, f"{time}: no {name} in the window")
            row[0].set_axis_off()
            row[1].set_axis_off()
            continue
        _draw_all(row[0], speeds, what.bin_width)
        _draw_samples(row[1], speeds, what)
        row[0].set_title(f"{time}: all {len(speeds)}", fontsize="small", loc="left")
        row[0].set_ylabel(f"{name} per {what.bin_width:g} m/s")
    for axes in grid[-1]:
        axes.set_xlabel("speed (m/s)")
    return figure


def _draw_all(axes: Axes, speeds: np.ndarray, bin_width: float) -> None:
    edges, counts = measure.speed_histogram(speeds, bin_width)
    axes.stairs(counts, edges, fill=True, color=ALL_COLOUR, alpha=0.85)
    mean = float(speeds.mean())
    axes.axvline(mean, color="black", linewidth=1, linestyle="--", label=f"mean {mean:.2f} m/s")
    axes.legend(fontsize="small", frameon=False)


def _draw_samples(axes: Axes, speeds: np.ndarray, what: SpeedHistogram) -> None:
    edges = measure.speed_edges(speeds, what.bin_width)
    mean, low, high = measure.sampled_histogram(speeds, edges, what.sample)
    axes.stairs(mean, edges, fill=True, color=SAMPLE_COLOUR, label="mean of the samples")
    some = mean > 0
    centres = (edges[1:] + edges[:-1])[some] / 2
    # A bin that few samples reach has its mean above 95 % of them.
    band = np.clip([(mean - low)[some], (high - mean)[some]], 0.0, None)
    axes.errorbar(
        centres, mean[some], band, fmt="none", color="black", capsize=2,
        linewidth=1, label="5 % to 95 % of them",
    )  # fmt: skip
    size = min(what.sample, len(speeds))
    axes.set_title(f"random samples of {size}", fontsize="small", loc="left")
    axes.set_ylabel(f"number of {size}")
    axes.legend(fontsize="small", frameon=False)
