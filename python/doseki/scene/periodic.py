"""Periodic axes of a scenario.  Lengths in m."""

from __future__ import annotations

import numpy as np

from ..scenario.model import Scenario


def periods(scenario: Scenario) -> np.ndarray:
    """The length (dim,) of the domain along each axis, zero where it is open."""
    length = np.zeros(scenario.dim)
    for axis in _axes(scenario):
        low, high = scenario.ends_of(axis)
        length[axis] = high - low
    return length


def wrapped(scenario: Scenario, position: np.ndarray) -> np.ndarray:
    """Positions (N, dim) inside the domain."""
    position = position.copy()
    for axis in _axes(scenario):
        low, high = scenario.ends_of(axis)
        along = low + (position[:, axis] - low) % (high - low)
        position[:, axis] = np.where(along < high, along, low)
    return position


def nearest_image(offset: np.ndarray, period: np.ndarray) -> np.ndarray:
    """The shortest of the vectors (N, dim) to all images; `period` as `periods` gives it."""
    whole = np.divide(offset, period, out=np.zeros_like(offset), where=period > 0)
    return offset - np.rint(whole) * period


def _axes(scenario: Scenario) -> list[int]:
    return ["xyz".index(name) for name in scenario.periodic]
