"""The moments that figures of snapshots show."""

from __future__ import annotations

import numpy as np

from ...measure.views import View, before_flow, fluid_names, select, with_flow
from ...record.reader import Run, Snapshot
from ...scenario.tables.figure import FigureOfSnapshots

MANY = 6  # most panels below each other


def caption(run: Run, table: FigureOfSnapshots, view: View, snapshots: list[Snapshot]) -> str:
    """The caption; it says so where a flow was to be shown that has not come."""
    title = table.title or view.title
    waits = table.when == "with_flow" and not table.times
    if waits and not np.any(select(snapshots[0], view, fluid_names(run))):
        return f"{title} (no fluid there yet)"
    return title


def chosen(run: Run, table: FigureOfSnapshots, view: View) -> list[Snapshot]:
    """The snapshots a figure table asks for, in order of time, none twice."""
    if table.times:
        indices = [int(np.argmin(np.abs(run.times - time))) for time in table.times]
        return [run[index] for index in sorted(set(indices))]
    choose = {
        "all": lambda: spread(run, MANY),
        "first": lambda: [run[0]],
        "last": lambda: [run[-1]],
        "before_flow": lambda: [run[before_flow(run, view)]],
        "with_flow": lambda: [run[with_flow(run, view)]],
    }
    return choose[table.when]()


def spread(run: Run, count: int) -> list[Snapshot]:
    """At most `count` snapshots, evenly spread from the first to the last."""
    indices = np.linspace(0, len(run) - 1, min(count, len(run))).round().astype(int)
    return [run[index] for index in indices]
