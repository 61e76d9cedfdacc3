"""The plane sides of a convex body where it stands.  Lengths in m."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .convex import Convex
from .outline import BULGE


class PlaneFaces(NamedTuple):
    """Sides of a convex body; points are counted from the middle of its extent."""

    place: np.ndarray  # (dim,) that middle
    normals: np.ndarray  # (m, dim) outwards
    distances: np.ndarray  # (m,) of their planes
    middles: np.ndarray  # (m, dim) a point of each
    low: np.ndarray  # (m, dim) where each ends along the axes
    high: np.ndarray  # (m, dim)

    @classmethod
    def of(cls, shape: Convex, place: np.ndarray, turn: np.ndarray) -> PlaneFaces:
        """Those of a shape with its centre of mass at a place, turned by a matrix (dim, dim)."""
        normals, distances = shape.planes
        corners = shape.outline.corners
        turned, limit = corners @ turn.T, BULGE * shape.reach
        shift = 0.5 * (turned.min(axis=0) + turned.max(axis=0))
        planes = zip(normals, distances, strict=True)
        sides = [turned[np.abs(corners @ n - distance) < limit] - shift for n, distance in planes]
        normals = normals @ turn.T
        middles, low, high = (
            np.array([end(side, axis=0) for side in sides]) for end in (np.mean, np.min, np.max)
        )
        return cls(place + shift, normals, distances - normals @ shift, middles, low, high)

    def gaps(self, point: np.ndarray) -> np.ndarray:
        """Distances (N, m) of points (N, dim) below the planes of the sides."""
        return np.asarray(self.distances - point @ self.normals.T)

    def feet(self, point: np.ndarray, sides: np.ndarray) -> np.ndarray:
        """The places (N, k, dim) on some of the sides above points (N, dim) within.

        A point above which a side has ended has its place on the rim.
        """
        middle, normal = self.middles[sides], self.normals[sides]
        gaps = self.distances[sides] - point @ normal.T
        along = point[:, None] + gaps[:, :, None] * normal - middle
        room = self.gaps(middle)
        room[np.arange(len(sides)), sides] = np.inf  # a side is no rim of its own
        beyond = np.ones(gaps.shape)
        for other, left in zip(self.normals, room.T, strict=True):
            np.maximum(beyond, along @ other / left, out=beyond)
        return np.asarray(middle + along / beyond[:, :, None])
