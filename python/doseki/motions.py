"""Prescribed motions of fixed bodies: moving walls, and gates that vanish."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .scenario import Scenario
    from .schema import Motion


def wall_motions(scenario: Scenario, body_names: list[str]) -> list[dict[str, Any]]:
    """The motions as the core reads them, SI units; `body_names` are those of `build_bodies`."""
    return [
        {
            "body": body_names.index(name),
            "velocity": _vector(motion.velocity, scenario.dim),
            "angular_velocity": spin_of(motion, scenario.dim).tolist(),
            "pivot": _vector(motion.pivot, scenario.dim),
            "start": motion.start,
            "stop": math.inf if motion.stop is None else motion.stop,
            "removed_at": math.inf if motion.removed_at is None else motion.removed_at,
        }
        for name, body in scenario.body.items()
        if (motion := getattr(body, "motion", None)) is not None
    ]


def spin_of(motion: Motion, dim: int) -> np.ndarray:
    """Angular velocity as a vector (3,), rad/s; in 2-D along the axis that is not there."""
    if motion.angular_velocity is None:
        return np.zeros(3)
    if dim == 2:
        return np.array([0.0, 0.0, float(motion.angular_velocity)])
    return np.array(motion.angular_velocity, dtype=float)


def _vector(vector: np.ndarray | None, dim: int) -> list[float]:
    return [0.0] * dim if vector is None else [float(x) for x in vector]


def check_motions(scenario: Scenario) -> None:
    """Raise UserError for motions of what is not fixed, or that the dimension or domain forbids."""
    for name, body in scenario.body.items():
        motion = getattr(body, "motion", None)
        if motion is not None:
            _check_body(scenario, name, body)
            _check_spin(scenario, name, motion)


def _check_body(scenario: Scenario, name: str, body: Any) -> None:
    keys = ("body", name, "motion")
    if not body.fixed:
        raise scenario.where.error(
            keys, f"body.{name}.motion: only a body with fixed = true has a prescribed motion"
        )
    if body.velocity is not None:
        raise scenario.where.error(
            keys,
            f"body.{name}.velocity and body.{name}.motion exclude each other: a fixed body with a"
            " velocity is a belt, which stays where it is",
        )


def _check_spin(scenario: Scenario, name: str, motion: Motion) -> None:
    if motion.angular_velocity is None:
        return
    keys, key = ("body", name, "motion"), f"body.{name}.motion.angular_velocity"
    if np.ndim(motion.angular_velocity) != (0 if scenario.dim == 2 else 1):
        wanted = "a number" if scenario.dim == 2 else "a vector of 3 entries"
        raise scenario.where.error(
            keys,
            f"{key} = {np.array(motion.angular_velocity).tolist()}: a {scenario.dim}-D run needs"
            f" {wanted}, rad/s",
        )
    spin = spin_of(motion, scenario.dim)
    for axis in scenario.periodic:
        along = np.arange(3) == "xyz".index(axis)
        if np.any(spin[~along]):
            raise scenario.where.error(
                keys, f"{key}: nothing can turn out of the periodic axis {axis}"
            )
