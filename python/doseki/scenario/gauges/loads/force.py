"""The force of the flow and of contacts on fixed bodies."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from ....record.particles import FIXED
from ...values.types import BodyNames
from ..gauge import Rows, Sampled, Setting
from .force_meter import ForceMeter, force_columns, impulse_of
from .metered import Row

CONTACT = "contact_"


class Force(ForceMeter):
    """Force and moment of the flow on fixed bodies, and of the bodies that touch them."""

    kind: Literal["force"]
    bodies: BodyNames = Field(description="names of fixed bodies")

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        return {"time": "s"} | force_columns("", dim) | force_columns(CONTACT, dim)

    def means(self, dim: int) -> list[str]:
        """Contacts are shorter than the time between samples."""
        return list(force_columns(CONTACT, dim))

    def rows(self, run: Sampled, setting: Setting, row: Row) -> Rows:
        """A sample: the force of the flow now, and the impulse of contacts since the start, which
        the meter of the core has summed.
        """
        state = run.state()
        of_them = setting.is_of_bodies(self.bodies, state) & (state["motion"] == FIXED)
        force, position = state["force"][of_them], state["position"][of_them]
        total, moment = force_and_moment(position, force, self.pole(setting.dim))
        moment = moment + state["moment"][of_them].sum(axis=0)
        contact = impulse_of(row, "contact", setting.dim)
        return [[run.time, *total, *moment, *map(float, contact)]]


def force_and_moment(
    position: np.ndarray, force: np.ndarray, about: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sum of forces (N, dim) and of their moments about a point; the moment is (1,) in 2-D."""
    arm = position - about
    if len(about) == 2:
        return force.sum(axis=0), np.array(
            [np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])]
        )
    return force.sum(axis=0), np.cross(arm, force).sum(axis=0)
