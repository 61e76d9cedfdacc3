"""The moments that figures of snapshots show."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...measure.moments import Moment, moments
from ...measure.views import View, before_flow, fluid_names, select, with_flow
from ...record.reader import Run
from ...scenario.tables.figure import FigureOfSnapshots
from ..nothing import NothingToDrawError

MANY = 6  # most panels below each other


def chosen(run: Run, table: FigureOfSnapshots, view: View) -> list[Moment]:
    """The snapshots a figure table asks for, in order of time, none twice.

    Raises NothingToDrawError where none of them shows anything in the window of the figure.
    """
    found = _chosen(run, table, view)
    if table.window is not None:
        materials = None if table.material is None else {table.material}
        waits = table.when == "with_flow" and not table.times
        looks = materials or fluid_names(run) if waits else materials
        # A window may be shown before something reaches it, if something does.
        before = table.when == "before_flow" and not table.times
        seen = range(len(run)) if before else [moment.index for moment in found]
        if not _is_reached(run, view, looks, seen):
            what = table.material or ("fluid" if waits else "particle")
            when = "ever" if before else "then"
            raise NothingToDrawError(f"no {what} is in the window {table.window} {when}")
    return found


def _is_reached(run: Run, view: View, materials: set[str] | None, seen: Iterable[int]) -> bool:
    return any(np.any(select(run[index], view, materials)) for index in seen)


def _chosen(run: Run, table: FigureOfSnapshots, view: View) -> list[Moment]:
    if table.times:
        indices = [int(np.argmin(np.abs(run.times - time))) for time in table.times]
        return [Moment(index, "") for index in sorted(set(indices))]
    choose = {
        "all": lambda: spread(run, MANY),
        "events": lambda: moments(run, view),
        "first": lambda: [Moment(0, "")],
        "last": lambda: [Moment(len(run) - 1, "")],
        "before_flow": lambda: [Moment(before_flow(run, view), "")],
        "with_flow": lambda: [Moment(with_flow(run, view), "")],
    }
    return choose[table.when]()


def spread(run: Run, count: int) -> list[Moment]:
    """At most `count` snapshots, evenly spread from the first to the last."""
    indices = np.linspace(0, len(run) - 1, min(count, len(run))).round().astype(int)
    return [Moment(int(index), "") for index in indices]
