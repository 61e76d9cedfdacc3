"""Gauges of the whole force on fixed bodies, and of its moment about a point."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from ....record.units import unit_in
from ...values.types import Position
from ..gauge import Setting
from .metered import Metered, Row


class ForceMeter(Metered):
    """One that sums forces and moments."""

    about: Position | None = Field(None, description="point of the moment, m; default: the origin")

    def meter(self, setting: Setting) -> dict[str, object]:
        """The table of the core's add_load_meter."""
        return super().meter(setting) | {"about": self.pole(setting.dim).tolist()}

    def pole(self, dim: int) -> np.ndarray:
        """The point (dim,) of the moment, m."""
        return np.zeros(dim) if self.about is None else self.about


def force_columns(prefix: str, dim: int) -> dict[str, str]:
    """Columns of a force and its moment, with their units."""
    axes = "xyz"[:dim]
    moments = ["moment"] if dim == 2 else [f"moment_{axis}" for axis in axes]
    forces = {f"{prefix}force_{axis}": unit_in("N", dim) for axis in axes}
    return forces | {f"{prefix}{moment}": unit_in("N m", dim) for moment in moments}


def about_axes(moment: np.ndarray, dim: int) -> np.ndarray:
    """The components of a moment (3,) that a run has."""
    return moment[2:] if dim == 2 else moment


def impulse_of(row: Row, name: str, dim: int) -> np.ndarray:
    """Of the "flow" or of "contact", since the start: force and moment."""
    return np.concatenate([row[f"{name}_impulse"], about_axes(row[f"{name}_turning"], dim)])
