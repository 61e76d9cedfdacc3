"""[body.NAME.motion]: a prescribed motion."""

from __future__ import annotations

import numpy as np
from pydantic import Field, model_validator

from ..table import Table
from ..values.types import Duration, Instant, Position, Spin, Velocity


class Motion(Table):
    """A prescribed motion of a fixed body."""

    velocity: Velocity | None = Field(None, description="of the body, m/s; default: none")
    angular_velocity: Spin | None = Field(
        None, description="anticlockwise, rad/s; 3-D: a vector; default: none"
    )
    pivot: Position | None = Field(
        None, description="point about which it turns, which goes with it, m"
    )
    start: Instant = Field(0.0, description="when it begins to move, s")
    stop: Duration | None = Field(None, description="when it stands still again, s")
    removed_at: Duration | None = Field(None, description="when the body vanishes, s")

    @model_validator(mode="after")
    def _fits_together(self) -> Motion:
        if self.stop is not None and self.stop <= self.start:
            raise ValueError(f"stop = {self.stop:g} s must be later than start = {self.start:g} s")
        if self.angular_velocity is not None and self.pivot is None:
            raise ValueError("angular_velocity needs a pivot, the point about which the body turns")
        if self.angular_velocity is None and self.pivot is not None:
            raise ValueError("pivot goes with angular_velocity")
        if self.velocity is None and self.angular_velocity is None and self.removed_at is None:
            raise ValueError("give velocity, angular_velocity or removed_at")
        turns_or_goes = self.velocity is not None or self.angular_velocity is not None
        if {"start", "stop"} & self.model_fields_set and not turns_or_goes:
            raise ValueError("start and stop go with velocity or angular_velocity")
        if self.removed_at is not None and self.removed_at <= self.start and turns_or_goes:
            raise ValueError(
                f"removed_at = {self.removed_at:g} s must be later than start = {self.start:g} s: "
                "a body that has vanished does not move"
            )
        return self

    def spin(self, dim: int) -> np.ndarray:
        """Angular velocity as a vector (3,), rad/s; in 2-D along the axis that is not there."""
        if self.angular_velocity is None:
            return np.zeros(3)
        if dim == 2:
            return np.array([0.0, 0.0, self.angular_velocity])
        return np.array(self.angular_velocity, dtype=float)
