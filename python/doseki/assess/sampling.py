"""What reading the gauges of a run will take, from a few readings with the flow at each of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from ..driver.counts import build_counts
from ..driver.gauges import GaugeReader, build_gauges
from ..driver.means import build_means
from ..driver.meters import build_meters
from ..record.particles import FIXED
from ..scenario.gauges.gauge import State
from ..scenario.gauges.loads.load import Load
from ..scenario.gauges.loads.overtopping import LOOKS
from ..scenario.model import Scenario
from ..solver.protocol import Simulation

READINGS = 2  # that are timed; what a gauge finds out once comes before them


def sampling_seconds(
    scenario: Scenario, simulation: Simulation, body_names: list[str], steps: float
) -> float:
    """Wall time, s, of all samples of the gauges in a run of so many steps.

    A gauge takes most of its time in a flow, which may be far from it at first: it is read as if
    the middle of the flow were there.
    """
    readers = build_gauges(scenario, body_names)
    if not readers or not len(simulation):
        return 0.0
    means, counts = {**build_means(readers), **build_meters(readers)}, build_counts(readers)
    state, length = simulation.state(), scenario.time_max - scenario.begins_at
    looks = steps if scenario.has_bodies_alone else steps / LOOKS
    total = 0.0
    for reader in readers:
        at, name = _FlowAt(simulation, state, _place(reader, state)), reader.name
        read = means[name].sample if name in means else reader.read
        every_step = reader.gauge.bandwidth is not None
        total += (steps if every_step else length / reader.interval + 1) * _seconds(read, at)
        if name in counts:
            total += looks * _seconds(counts[name].look, at)
    return total


def _seconds(read: Callable[[Any], object], run: _FlowAt) -> float:
    read(run)
    started = time.perf_counter()
    for _ in range(READINGS):
        run.time += run.timestep  # means are those over some time
        read(run)
    return (time.perf_counter() - started) / READINGS


def _place(reader: GaugeReader, state: State) -> np.ndarray | None:
    """Where a gauge looks, (dim,) m; None where that is no place."""
    if isinstance(reader.gauge, Load):
        own = reader.setting.is_of_bodies(reader.gauge.bodies, state)
        return np.asarray(state["position"][own].mean(axis=0)) if own.any() else None
    return reader.gauge.place


class _FlowAt:
    """A simulation with the middle of all that moves at a place."""

    def __init__(self, simulation: Simulation, state: State, place: np.ndarray | None) -> None:
        self._simulation, self.time = simulation, simulation.time
        moving = state["position"][state["motion"] != FIXED]
        self._shift = np.zeros(state["position"].shape[1])
        if place is not None and len(moving):
            self._shift = place - moving.mean(axis=0)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._simulation, name)

    def sample(self, low: list[float], high: list[float]) -> State:
        """Fields of the particles in a box, m."""
        walls = self._simulation.sample(low, high)
        flow = self._simulation.sample(list(low - self._shift), list(high - self._shift))
        flow["position"] = flow["position"] + self._shift
        still, moves = walls["motion"] == FIXED, flow["motion"] != FIXED
        return {key: np.concatenate([walls[key][still], flow[key][moves]]) for key in walls}
