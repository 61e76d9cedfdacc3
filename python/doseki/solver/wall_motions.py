"""Prescribed motions of fixed bodies, as the core reads them: moving walls, gates that vanish."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..scenario.model import Scenario


def wall_motions(scenario: Scenario, body_names: list[str]) -> list[dict[str, Any]]:
    """The motions as the core reads them, SI units; `body_names` are those of `build_bodies`."""
    return [
        {
            "body": body_names.index(name),
            "velocity": _vector(motion.velocity, scenario.dim),
            "angular_velocity": motion.spin(scenario.dim).tolist(),
            "pivot": _vector(motion.pivot, scenario.dim),
            "start": motion.start,
            "stop": math.inf if motion.stop is None else motion.stop,
            "removed_at": math.inf if motion.removed_at is None else motion.removed_at,
        }
        for name, body in scenario.body.items()
        if (motion := body.prescribed_motion) is not None
    ]


def _vector(vector: np.ndarray | None, dim: int) -> list[float]:
    return [0.0] * dim if vector is None else [float(x) for x in vector]
