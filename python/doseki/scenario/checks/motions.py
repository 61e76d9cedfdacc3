"""Checks of the prescribed motions of bodies."""

from __future__ import annotations

import numpy as np

from ..model import Scenario
from ..tables.body import BodyTable
from ..tables.motion import Motion


def check_motions(scenario: Scenario) -> None:
    """Raise UserError for motions of what is not fixed, or that the dimension or domain forbids."""
    for name, body in scenario.body.items():
        motion = body.prescribed_motion
        if motion is not None:
            _check_body(scenario, name, body)
            _check_spin(scenario, name, motion)


def _check_body(scenario: Scenario, name: str, body: BodyTable) -> None:
    keys = ("body", name, "motion")
    if not body.fixed:
        raise scenario.where.error(
            keys, f"body.{name}.motion: only a body with fixed = true has a prescribed motion"
        )
    if body.given("velocity") is not None:
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
    spin = motion.spin(scenario.dim)
    for axis in scenario.periodic:
        along = np.arange(3) == "xyz".index(axis)
        if np.any(spin[~along]):
            raise scenario.where.error(
                keys, f"{key}: nothing can turn out of the periodic axis {axis}"
            )
