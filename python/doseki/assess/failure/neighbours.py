"""The particles around one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...scenario.model import Scenario
from ...scenario.schemes import KERNEL_SUPPORT
from ...scene.periodic import nearest_image, periods

State = Mapping[str, np.ndarray]


def neighbours_of(scenario: Scenario, state: State, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Indices (n,) of the particles within support of particle `k`, nearest first, and their
    distances (n,), m.
    """
    offset = nearest_image(state["position"] - state["position"][k], periods(scenario))
    distance = np.linalg.norm(offset, axis=1)
    h = state["smoothing_length"]
    near = np.flatnonzero(distance < KERNEL_SUPPORT[scenario.kernel] * np.maximum(h, h[k]))
    near = near[near != k]
    near = near[np.argsort(distance[near], kind="stable")]
    return near, distance[near]
