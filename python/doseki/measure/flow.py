"""The flow over time, measured on the snapshots of a run: its front, and what windows show."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ..record.reader import Run, Snapshot
from . import numbers as measure
from .advance import Advance, goes_along_x
from .census.grains import Grains, grains_of
from .grading import structure_names
from .views import (
    View,
    flow_direction,
    fluid_names,
    select,
    way_of_flow,
    whole_space,
    windows,
)


@dataclass
class WindowFlow:
    """What a window shows, one entry per snapshot; nan where nothing is there."""

    view: View
    fluid_count: list[int] = field(default_factory=list)
    fluid_velocity: list[float] = field(default_factory=list)  # mean along the first axis, m/s
    grain_count: list[int] = field(default_factory=list)
    grain_speed: list[float] = field(default_factory=list)  # mean, m/s
    grain_mass: list[float] = field(default_factory=list)  # kg (2-D: kg/m)
    passed_mass: list[float] = field(default_factory=list)  # beyond its downstream end, kg (kg/m)

    def arrival(self, times: np.ndarray) -> float:
        """Time of the first snapshot with fluid in the window, s; nan if there is none."""
        there = np.flatnonzero(self.fluid_count)
        return float(times[there[0]]) if len(there) else math.nan


@dataclass
class Flow:
    """The flow of a run: times (s), position of the front (m), and its windows by name.

    The front is the x of the foremost fluid where the flow goes along x, else how far it has come
    on the map (Advance).
    """

    times: np.ndarray
    front: np.ndarray
    windows: dict[str, WindowFlow]
    along_x: bool = True


def measure_flow(run: Run) -> Flow | None:
    """Measure every snapshot; None where no fluid is in the run.

    Fluid is every material with the law "fluid"; grains are those of the census, so that a body
    of many particles is one.
    """
    fluids, structures = fluid_names(run), structure_names(run)
    everywhere = whole_space(run.scenario["dim"])
    direction, way = flow_direction(run), way_of_flow(run) or 1
    seen = {name: WindowFlow(view) for name, view in windows(run).items()}
    passed = {name: _section(entry.view, direction) for name, entry in seen.items()}
    front, advance = [], None if goes_along_x(run) else Advance(run)
    for snapshot in run:
        is_fluid = select(snapshot, everywhere, fluids)
        if advance is None:
            front.append(measure.front(snapshot["position"][is_fluid, 0], way))
        else:
            front.append(advance.look(snapshot, is_fluid))
        grains = grains_of(snapshot, fluids, structures)
        for name, entry in seen.items():
            _look(entry, snapshot, is_fluid, grains)
            entry.passed_mass.append(_passed(passed[name], grains))
    if not np.any(np.isfinite(front)):
        return None
    return Flow(run.times, np.array(front), seen, advance is None)


def _look(entry: WindowFlow, snapshot: Snapshot, is_fluid: np.ndarray, grains: Grains) -> None:
    """Append what the window of `entry` shows in one snapshot: grains by their centres."""
    fluid = select(snapshot, entry.view) & is_fluid
    grain = entry.view.contains(grains.position)
    velocity, mass = snapshot["velocity"], snapshot["mass"]
    entry.fluid_count.append(int(np.count_nonzero(fluid)))
    entry.fluid_velocity.append(float(measure.mean_velocity(velocity[fluid], mass[fluid])[0]))
    entry.grain_count.append(int(np.count_nonzero(grain)))
    entry.grain_speed.append(_mean(grains.speed[grain]))
    entry.grain_mass.append(float(grains.mass[grain].sum()))


def _section(view: View, direction: int) -> measure.PassedMass | None:
    """The section at the downstream end of a window that lies along the first axis."""
    end = view.lower[0] if direction < 0 else view.upper[0]
    along = view.rotate == 0 and math.isfinite(end)
    return measure.PassedMass(float(end), direction) if along else None


def _passed(section: measure.PassedMass | None, grains: Grains) -> float:
    if section is None:
        return math.nan
    return section.update(grains.position[:, 0], grains.mass, grains.id)


def _mean(values: Iterable[float]) -> float:
    values = np.asarray(values)
    return float(values.mean()) if len(values) else math.nan
