"""Flows on a map, told apart: what spread from which place, and what only stood there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import label
from scipy.spatial import cKDTree

from ...geodata.grid import Raster
from .quantities import ARRIVAL_TIME, DEPOSIT, PEAK_SPEED

AROUND = np.ones((3, 3), int)  # cells that touch
REACH = 10.0  # cells between two looks at which a flow is still the same one
FASTER = 2.0  # times its largest speed, as which a flow may have come between two looks


@dataclass(frozen=True)
class Flows:
    """Which cells (rows, cols) are of which flow.

    Attributes:
        still: wet from the first look to the last, and never moved.
        start: the patch of cells where a flow was first seen, 1, 2 ...; 0 elsewhere.
        flow: the flow that reached the cell, 1, 2 ...; 0 where none did. Its own patches are
            reached, too.

    """

    still: np.ndarray
    start: np.ndarray
    flow: np.ndarray


def flows_on(maps: Mapping[str, Raster], rest: float) -> Flows:
    """Tell flows apart by the order in which cells were reached; `rest`, m/s: slower is at rest.

    Patches of touching cells that are wet when something is first seen each begin a flow. A cell
    that becomes wet later belongs to the flow of the nearest cell that was wet before, or begins
    one if there is none near; flows whose cells touch are one from then on.
    """
    arrival = maps[ARRIVAL_TIME.name].values
    wet = ~np.isnan(arrival)
    if not wet.any():
        nothing = np.zeros(arrival.shape, int)
        return Flows(wet, nothing, nothing)
    speed = np.nan_to_num(maps[PEAK_SPEED.name].values)
    lies = np.nan_to_num(maps[DEPOSIT.name].values) > 0
    still = wet & (arrival == arrival[wet].min()) & (speed < rest) & lies
    if not (wet & ~still).any():
        still = np.zeros(arrival.shape, bool)  # a flow that has not begun
    start, own = _spread(np.where(still, np.nan, arrival), speed, maps[ARRIVAL_TIME.name].cell)
    return Flows(still, start, _joined(own))


def _spread(arrival: np.ndarray, speed: np.ndarray, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """The patches in which flows begin, and the patch (rows, cols) that each cell comes from."""
    start, own = np.zeros(arrival.shape, int), np.zeros(arrival.shape, int)
    times = np.unique(arrival[~np.isnan(arrival)])
    for before, time in zip([times[0], *times], times, strict=False):
        new = np.argwhere(arrival == time)
        known = np.argwhere(own > 0)
        near = np.zeros(len(new), bool)
        if len(known):
            distance, nearest = cKDTree(known).query(new)
            come = FASTER * speed[tuple(new.T)] * (time - before) / cell
            near = distance <= np.maximum(REACH, come)
            own[tuple(new[near].T)] = own[tuple(known[nearest[near]].T)]
        alone = np.zeros(arrival.shape, bool)
        alone[tuple(new[~near].T)] = True
        patches, _ = label(alone, AROUND)
        patches[alone] += start.max()
        start[alone], own[alone] = patches[alone], patches[alone]
    return start, own


def _joined(own: np.ndarray) -> np.ndarray:
    """The same with one number for patches whose cells touch: the lowest."""
    number = np.arange(own.max() + 1)
    padded = np.pad(own, 1)
    rows, columns = own.shape
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        there = padded[1 + down : 1 + down + rows, 1 + right : 1 + right + columns]
        meet = (own > 0) & (there > 0) & (own != there)
        for pair in np.unique(np.sort(np.stack([own[meet], there[meet]], 1), axis=1), axis=0):
            low, high = sorted(number[pair])
            number[number == high] = low
    return np.asarray(number[own])
