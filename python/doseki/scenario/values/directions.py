"""Unit vectors of a run: upwards, and the axes of a section."""

from __future__ import annotations

import numpy as np


def upwards(gravity: np.ndarray, wish: np.ndarray | None = None) -> np.ndarray:
    """Unit vector of `wish`; without one against gravity, without gravity the last axis."""
    for direction in (wish, -gravity):
        if direction is not None and np.any(direction):
            return direction / np.linalg.norm(direction)
    return np.eye(len(gravity))[-1]


def section_axes(
    direction: np.ndarray, gravity: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None]:
    """Unit vectors within the section: upwards, and in 3-D across (towards positive axes).

    Upwards is against gravity as far as the section allows, without gravity along the last axis;
    for a vertical flow it is along the first axis.
    """
    last, first = np.eye(len(direction))[[-1, 0]]
    for wish in (-gravity, last, first):
        up = wish - (wish @ direction) * direction
        if np.linalg.norm(up) > 1e-6 * max(float(np.linalg.norm(wish)), 1e-300):
            up /= np.linalg.norm(up)
            break
    if len(direction) == 2:
        return up, None
    across = np.cross(direction, up)
    return up, across * np.sign(across[np.argmax(np.abs(across))])
