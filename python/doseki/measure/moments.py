"""The moments at which something happened: when a flow arrived, was at its peak, and ended."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..record.reader import Run, Snapshot
from .advance import Advance, goes_along_x
from .views import View, select, way_of_flow, what_flows

ARRIVED = 0.95  # of the way that the front ever goes
AHEAD = 99  # per cent of what flows is behind the front; the rest may be spray


@dataclass(frozen=True)
class Moment:
    """A snapshot by its index, and what happened then."""

    index: int
    name: str


@dataclass(frozen=True)
class _Look:
    """What a snapshot shows in a view."""

    energy: float  # kinetic, of what moves, J (2-D: J/m)
    count: int  # of what flows
    ends: tuple[float, float]  # along the first axis, of what flows, m
    way: float  # on a map: how far what flows has come, m


def moments(run: Run, view: View) -> list[Moment]:
    """The start, the arrival, the peak and the end, in order of time; none twice.

    A flow arrives when it is first seen in a window; where the view has no bounds, when its front
    has come 95 % of its way. What flows is fluid, or all that moves where there is none. At the
    peak the kinetic energy in the view is greatest; where it was greatest at the start, the least
    is shown: bodies meet.
    """
    materials = what_flows(run)
    advance = None if goes_along_x(run) else Advance(run)
    looks = [_look(snapshot, view, materials, advance) for snapshot in run]
    found = {0: ["start"]}
    energies = np.array([look.energy for look in looks])
    arrival, peak = _arrival(run, view, looks, advance is None), int(np.argmax(energies))
    if arrival is not None and arrival < len(looks) - 1:  # else it may still be on its way
        found.setdefault(arrival, []).append("arrival")
    if peak > 0:
        found.setdefault(peak, []).append("peak")
    elif 0 < (least := int(np.argmin(energies))) < len(looks) - 1:
        found.setdefault(least, []).append("least kinetic energy")
    found.setdefault(len(looks) - 1, []).append("end")
    return [Moment(index, ", ".join(found[index])) for index in sorted(found)]


def _look(
    snapshot: Snapshot, view: View, materials: set[str] | None, advance: Advance | None
) -> _Look:
    moving = select(snapshot, view)
    mass, velocity = snapshot["mass"][moving], snapshot["velocity"][moving]
    flows = select(snapshot, view, materials)
    along = snapshot["position"][flows][:, 0]
    ends = np.percentile(along, (100 - AHEAD, AHEAD)) if len(along) else (math.nan, math.nan)
    energy = 0.5 * float(mass @ (velocity**2).sum(axis=1))
    way = advance.look(snapshot, flows) if advance else math.nan
    return _Look(energy, len(along), (ends[0], ends[1]), way)


def _arrival(run: Run, view: View, looks: list[_Look], along_x: bool) -> int | None:
    if np.isfinite([view.lower[0], view.upper[0]]).all():
        there = np.flatnonzero([look.count for look in looks])
        return int(there[0]) if len(there) else None
    if along_x:
        way = way_of_flow(run)
        fronts = np.array([way * look.ends[1 if way > 0 else 0] for look in looks])
    else:
        way, fronts = 1, np.array([look.way for look in looks])
    if way == 0 or not np.isfinite(fronts).any():
        return None
    gone = fronts - fronts[np.isfinite(fronts)][0]
    farthest = np.nanmax(gone)
    return int(np.flatnonzero(gone >= ARRIVED * farthest)[0]) if farthest > 0 else None
