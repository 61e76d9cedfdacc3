"""The force of the flow on fixed bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np
from pydantic import Field

from ...record.particles import FIXED
from ...record.units import unit_in
from ..schemes import UETA2022
from ..values.types import BodyNames, Position
from .gauge import Gauge, Rows, Sampled, Setting


class ForceGauge(Gauge):
    """Force and moment of the flow on fixed bodies."""

    kind: Literal["force"]
    bodies: BodyNames = Field(description="names of fixed bodies")
    about: Position | None = Field(None, description="point of the moment, m; default: the origin")

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        axes = "xyz"[:dim]
        force, moment = unit_in("N", dim), unit_in("N m", dim)
        moments = ["moment"] if dim == 2 else [f"moment_{axis}" for axis in axes]
        return (
            {"time": "s"}
            | {f"force_{axis}": force for axis in axes}
            | dict.fromkeys(moments, moment)
        )

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """Its bodies must be fixed, and the scheme must know forces on walls."""
        for name in self.bodies:
            if not setting.fixed[name]:
                yield "bodies", f': "{name}" is not a fixed body'
        if setting.scheme == UETA2022:
            yield (
                "kind",
                f' = "force" needs scheme = "resolved"; {setting.scheme} has no force on walls',
            )

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """The time, and the sums of forces and of their moments."""
        state = run.state()
        of_them = setting.is_of_bodies(self.bodies, state) & (state["motion"] == FIXED)
        force, position = state["force"][of_them], state["position"][of_them]
        about = np.zeros(setting.dim) if self.about is None else self.about
        total, moment = force_and_moment(position, force, about)
        return [[run.time, *total, *(moment + state["moment"][of_them].sum(axis=0))]]


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
