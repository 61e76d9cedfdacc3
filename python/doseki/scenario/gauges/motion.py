"""The motion of bodies that move: where they are, how fast, how turned, and what pushes them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, cast

import numpy as np
from pydantic import Field

from ...record.units import unit_in
from ..kinematics import RIGID, SINGLE
from ..values.types import BodyNames
from .gauge import Gauge, Rows, Sampled, Setting, State

GrainNumber = Annotated[int, Field(ge=0)]


class Motion(Gauge):
    """Path, velocity, rotation and forces of rigid bodies, or of grains of a packing."""

    kind: Literal["motion"]
    bodies: BodyNames = Field(description="names of rigid bodies, or of packings of them")
    grains: list[GrainNumber] | None = Field(
        None,
        min_length=1,
        description="numbers of grains among those of `bodies`, from 0; default: all",
    )

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        axes = "xyz"[:dim]
        turned = {"angle": "rad", "spin": "rad/s"}
        if dim == 3:
            turned = {f"orientation_{part}": "1" for part in "wxyz"}
            turned |= {f"spin_{axis}": "rad/s" for axis in axes}
        return (
            {"time": "s", "grain": "1"}
            | dict.fromkeys(axes, "m")
            | {f"velocity_{axis}": "m/s" for axis in axes}
            | turned
            | dict.fromkeys(self.means(dim), unit_in("N", dim))
        )

    def means(self, dim: int) -> list[str]:
        """The columns that are means since the sample before."""
        return [
            f"{name}_{axis}" for name in ("flow_force", "contact_force") for axis in "xyz"[:dim]
        ]

    @property
    def series(self) -> str:
        """The column by which rows of one time are told apart."""
        return "grain"

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        axes = "xyz"[:dim]
        return [*axes, *(f"velocity_{axis}" for axis in axes), *self.means(dim)]

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """Its bodies must be rigid ones that move."""
        for name in self.bodies:
            found = setting.kinematics[name]
            if found not in (RIGID.name, SINGLE.name):
                other = "force" if setting.fixed[name] else "mass_centre"
                yield (
                    "bodies",
                    f': "{name}" is no rigid body that moves (its kinematics are "{found}"); '
                    f'kind = "{other}" reads it',
                )

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """A row for each grain: in place of mean forces the impulses since the start.

        nan where a grain has left the run.
        """
        table = cast(State, run.grains())
        moves = ~table["fixed"]
        mine = setting.is_of_bodies(self.bodies, table) & moves
        rows = np.flatnonzero(mine)[self.grains if self.grains is not None else slice(None)]
        number = np.cumsum(moves)[rows] - 1  # its row in the table of a snapshot
        found = {key: table[key][rows] for key in KEYS}
        turned = [found["orientation"], found["spin"]]
        if setting.dim == 2:
            w, z = found["orientation"][:, [0, 3]].T
            angle = np.arctan2(2 * w * z, w**2 - z**2)  # of a quaternion, which has its half
            turned = [angle[:, None], found["spin"][:, 2:]]
        told = [found["centre"], found["velocity"], *turned]
        told += [found["flow_impulse"], found["contact_impulse"]]
        values = np.concatenate(told, axis=1)
        values[table["removed"][rows]] = np.nan
        return [
            [run.time, float(grain), *of_grain]
            for grain, of_grain in zip(number, values.tolist(), strict=True)
        ]


KEYS = ("centre", "velocity", "orientation", "spin", "flow_impulse", "contact_impulse")
