"""Where fixed bodies with a prescribed motion are, as when a run begins later than at zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..record.particles import ParticleSet
from ..scenario.model import Scenario
from ..scenario.tables.motion import Motion
from .groups import UPRIGHT, Group, matrices


def is_gone(scenario: Scenario, name: str, now: float | None = None) -> bool:
    """Whether a body has been removed at a time, s; default: before the run begins."""
    motion = scenario.body[name].prescribed_motion
    now = scenario.begins_at if now is None else now
    return motion is not None and (motion.removed_at or np.inf) <= now


class Displacement:
    """How a body [body.NAME] has moved until a time, s; not at all without a motion.

    Without a time until the run begins.
    """

    def __init__(self, scenario: Scenario, name: str, now: float | None = None) -> None:
        motion, self._dim = scenario.body[name].prescribed_motion, scenario.dim
        self._turn, self._shift, self._pivot = UPRIGHT, np.zeros(self._dim), np.zeros(self._dim)
        if motion is not None:
            self._take(motion, scenario.begins_at if now is None else now)

    def _take(self, motion: Motion, now: float) -> None:
        spent = max(min(now, np.inf if motion.stop is None else motion.stop) - motion.start, 0.0)
        if motion.velocity is not None:
            self._shift = spent * np.asarray(motion.velocity, float)
        spin = motion.spin(self._dim)
        if rate := float(np.linalg.norm(spin)):
            half = 0.5 * rate * spent
            self._turn = np.array([np.cos(half), *(np.sin(half) * spin / rate)])
            self._pivot = np.asarray(motion.pivot, float)

    @property
    def is_none(self) -> bool:
        """Whether it stands where it was."""
        return not self._shift.any() and np.array_equal(self._turn, UPRIGHT)

    def vectors(self, vector: np.ndarray) -> np.ndarray:
        """What becomes of vectors (N, dim) that are fixed to the body."""
        return vector @ matrices(self._turn[None], self._dim)[0].T

    def points(self, position: np.ndarray) -> np.ndarray:
        """Where its points (N, dim) are, m."""
        return self._pivot + self.vectors(position - self._pivot) + self._shift

    def particles(self, particles: ParticleSet) -> ParticleSet:
        """Its particles where they are."""
        if self.is_none:
            return particles
        return replace(particles, position=self.points(particles.position))

    def group(self, group: Group) -> Group:
        """Its bodies where they are."""
        if self.is_none:
            return group
        turned = np.stack([_product(self._turn, one) for one in group.orientation])
        return replace(group, centre=self.points(group.centre), orientation=turned)


def _product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The quaternion (4,) of the second rotation and then the first."""
    w, v, u, s = first[0], first[1:], second[0], second[1:]
    return np.array([w * u - v @ s, *(w * s + u * v + np.cross(v, s))])
