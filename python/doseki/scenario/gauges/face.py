"""The face of a sensor that is let into a wall: which wall particles are its own."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...record.particles import FIXED, FREE
from .gauge import State

FACING = 0.5  # least cosine between the normal of a wall particle and that of the face
NEARNESS = 1e-3  # what a spacing away counts for beside one off the plane of the face


def at_surface(state: State, gravity: np.ndarray) -> np.ndarray:
    """Pressure (N,) at the surfaces of walls, Pa: their particles have that of their own depth."""
    flow = state["motion"] == FREE
    pressure = state["pressure"]
    if not flow.any():
        return pressure
    rho = float(state["density"][flow].mean())
    wet = (state["motion"] == FIXED) & (pressure != 0.0)
    return pressure + wet * (rho * state["depth"] * (state["normal"] @ gravity))


@dataclass(frozen=True)
class Face:
    """A piece of a wall, SI units: in 2-D a length, in 3-D a disc."""

    position: np.ndarray  # (dim,) its middle, on the surface of the wall
    area: float  # m2; 2-D: m
    dp: float
    direction: np.ndarray | None = None  # into the flow; None: that of the wall

    @property
    def dim(self) -> int:
        """Dimensions of the run."""
        return len(self.position)

    @property
    def diameter(self) -> float:
        """Of the disc, m; in 2-D the length."""
        return self.area if self.dim == 2 else math.sqrt(4 * self.area / math.pi)

    @property
    def radius(self) -> float:
        """Half its diameter, m, or half a spacing if that is more: no less can be told."""
        return 0.5 * max(self.diameter, self.dp)

    @property
    def reach(self) -> float:
        """How far from its middle wall particles are looked for, m."""
        return self.radius + 2 * self.dp

    def weights(self, state: State) -> np.ndarray:
        """Share (N,) of the cell of each particle, of a wall at its surface, that it covers.

        A cell counts from one spacing beyond the edge of the face, as a straight line: the mean
        that follows does not jump as a face is moved, and of a face smaller than a spacing it is
        the pressure in its middle, interpolated.
        """
        away = state["position"] - self.position
        surface = (state["motion"] == FIXED) & (state["depth"] < self.dp)
        offset = np.einsum("ij,ij->i", away, state["normal"]) + state["depth"]
        surface &= np.linalg.norm(away, axis=1) < self.reach
        if not surface.any():
            return np.zeros(len(away))
        normal = self._normal(state, away, offset, surface)
        facing = (state["normal"] @ normal > FACING) & (np.abs(offset) < 0.5 * self.dp)
        # A particle of an edge has the normal of one of its faces; that of a corner that is hollow
        # is on the other side of the middle.
        below = np.abs(away @ normal + 0.5 * self.dp) < 0.5 * self.dp
        surface &= facing | (below & (offset > 1e-6 * self.dp))
        aside = np.linalg.norm(away - np.outer(away @ normal, normal), axis=1)
        return surface * np.clip((self.radius - aside) / self.dp + 0.5, 0.0, 1.0)

    def _normal(
        self, state: State, away: np.ndarray, offset: np.ndarray, surface: np.ndarray
    ) -> np.ndarray:
        """As given, or that of the surface which the middle lies on."""
        if self.direction is not None:
            return self.direction / np.linalg.norm(self.direction)
        far = np.abs(offset) + NEARNESS * np.linalg.norm(away, axis=1)
        return state["normal"][np.argmin(np.where(surface, far, np.inf))]

    def covered(self, state: State) -> float:
        """How much of the face is wall; 1 but for rounding to particles where all of it is."""
        radius = self.radius / self.dp
        whole = 2 * radius if self.dim == 2 else math.pi * (radius**2 + 1 / 12)
        return float(self.weights(state).sum()) / whole

    @property
    def least_covered(self) -> float:
        """Share below which a face is larger than its wall."""
        return 0.8 if self.diameter >= self.dp else 0.4
