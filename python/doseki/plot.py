"""The figures of a run: those its scenario asks for, and those every run gets."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from .errors import UserError
from .figure_flow import draw_flow
from .figure_gauge import draw_gauge
from .figure_histogram import SpeedHistogram, draw_histogram
from .figure_series import ENERGIES, MASSES, draw_history
from .figure_snapshot import SnapshotFigure, draw_snapshots
from .flow import measure_flow
from .loading import Run, Snapshot, load
from .record import refuse_links
from .storage import clear_errors, write_whole
from .views import (
    View,
    before_flow,
    fluid_names,
    named_window,
    select,
    tables,
    tilt,
    whole_space,
    with_flow,
)

FEW = 2000  # a run of no more particles is also drawn with the support, as Figs. 3 and 4
MANY = 6  # most panels below each other


def plot_run(directory: str | Path) -> list[Path]:
    """Draw every figure of the run in `directory` into DIR/figures; returns the PNG files.

    Raises UserError when there is no run, no snapshot, or a figure that cannot be drawn.
    """
    run = load(directory)
    if not len(run):
        raise UserError(f"{directory}: the run has no snapshot to draw")
    refuse_links(run.folder)
    return [_save(figure, run, name) for name, figure in figures(run)]


def figures(run: Run) -> Iterator[tuple[str, Figure]]:
    """Every figure of a run with its name, one after the other.

    A figure of the scenario replaces a general one of the same name.
    """
    asked = tables(run, "figure")
    for name, make in GENERAL.items():
        if name not in asked and (figure := make(run)) is not None:
            yield name, figure
    for name, table in asked.items():
        yield name, ASKED[table.kind](run, table)


def _energy(run: Run) -> Figure | None:
    known = set(ENERGIES) <= set(run.history)
    return draw_history(run, ENERGIES, "Energy") if known else None


def _mass(run: Run) -> Figure | None:
    known = set(MASSES) <= set(run.history)
    return draw_history(run, MASSES, "Mass ledger") if known else None


def _flow(run: Run) -> Figure | None:
    flow = measure_flow(run)
    return draw_flow(run, flow) if flow is not None else None


def _overview(run: Run) -> Figure:
    """The whole domain at the start, in the middle and at the end, gravity pointing down."""
    view = whole_space(run.scenario["dim"], rotate=-tilt(run))
    what = SnapshotFigure(view, ["material"], run.scenario.get("title", ""))
    return draw_snapshots(run, _spread(run, 3), what)


def _snapshot_figure(run: Run, table: Any) -> Figure:
    view = named_window(run, table.window)
    snapshots = _chosen(run, table, view)
    few = table.window is None and max(len(s["id"]) for s in snapshots) <= FEW
    sizes = ("support", "grain") if few else ("grain",)
    title = _title(run, table, view, snapshots)
    what = SnapshotFigure(view, table.colour, title, sizes, table.material)
    return draw_snapshots(run, snapshots, what)


def _histogram_figure(run: Run, table: Any) -> Figure:
    view = named_window(run, table.window)
    snapshots = _chosen(run, table, view)
    title = _title(run, table, view, snapshots)
    what = SpeedHistogram(view, table.material, table.bin_width, table.sample, title)
    return draw_histogram(run, snapshots, what)


def _title(run: Run, table: Any, view: View, snapshots: list[Snapshot]) -> str:
    """The caption; it says so where a flow was to be shown that has not come."""
    title = table.title or view.title
    waits = table.when == "with_flow" and not table.times
    if waits and not np.any(select(snapshots[0], view, fluid_names(run))):
        return f"{title} (no fluid there yet)"
    return title


def _series_figure(run: Run, table: Any) -> Figure:
    return draw_history(run, table.columns, table.title)


def _gauge_figure(run: Run, table: Any) -> Figure:
    return draw_gauge(run, table.gauge, table.columns, table.times, table.title)


def _chosen(run: Run, table: Any, view: View) -> list[Snapshot]:
    """The snapshots a figure table asks for, in order of time, none twice."""
    if table.times:
        indices = [int(np.argmin(np.abs(run.times - time))) for time in table.times]
        return [run[index] for index in sorted(set(indices))]
    choose = {
        "all": lambda: _spread(run, MANY),
        "first": lambda: [run[0]],
        "last": lambda: [run[-1]],
        "before_flow": lambda: [run[before_flow(run, view)]],
        "with_flow": lambda: [run[with_flow(run, view)]],
    }
    return choose[table.when]()


def _spread(run: Run, most: int) -> list[Snapshot]:
    """At most `most` snapshots, evenly spread from the first to the last."""
    indices = np.linspace(0, len(run) - 1, min(most, len(run))).round().astype(int)
    return [run[index] for index in indices]


GENERAL = {"overview": _overview, "energy": _energy, "mass": _mass, "flow": _flow}
ASKED = {
    "snapshot": _snapshot_figure,
    "histogram": _histogram_figure,
    "series": _series_figure,
    "gauge": _gauge_figure,
}


def _save(figure: Figure, run: Run, name: str) -> Path:
    path = run.folder.figures / f"{name}.png"
    with clear_errors(path):
        path.parent.mkdir(exist_ok=True)
    write_whole(path, lambda temporary: figure.savefig(temporary, format="png"))
    return path
