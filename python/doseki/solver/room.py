"""Room in the ground of a terrain for the bodies that stand in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..scenario.model import Scenario
from ..scene.carried import present
from ..scene.kinds.body import Body
from ..scene.kinds.registry import bodies_of
from .protocol import CoreSimulation

PARTS = {2: 10, 3: 6}  # along each side of a cell, by which its remainder is counted


def make_room_for_bodies(simulation: CoreSimulation, scenario: Scenario) -> None:
    """Leave the space of bodies that are fixed for good to their own wall particles.

    Where those of the ground were there too, they would bear a part of the load on the body.  What
    moves, or goes, would leave a hole in the ground.
    """
    standing = [
        body
        for name, body in present(scenario, bodies_of(scenario)).items()
        if scenario.body[name].fixed and scenario.body[name].prescribed_motion is None
    ]
    if standing:
        simulation.make_room_in_terrain(remainder_of(standing, scenario.dim, scenario.dp))


def remainder_of(
    bodies: Sequence[Body[Any]], dim: int, dp: float
) -> Callable[[list[float]], np.ndarray]:
    """What bodies leave of cells of `dp`, m: see CoreSimulation.make_room_in_terrain."""

    def inside(position: np.ndarray) -> np.ndarray:
        found = np.zeros(len(position), bool)
        for body in bodies:
            found |= body.encloses(position)
        return found

    def remainder(cells: list[float]) -> np.ndarray:
        place, normal = np.reshape(cells, (-1, 2, dim)).swapaxes(0, 1)
        axes = dp * _frames(normal)

        def taken(rows: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            points = place[rows, None] + np.einsum("pa,nab->npb", parts, axes[rows])
            return points, inside(points.reshape(-1, dim)).reshape(points.shape[:2])

        everywhere = np.arange(len(place))
        _, corners = taken(everywhere, _lattice(3, dim))
        share, middle = 1.0 - corners[:, 0], place.copy()
        cut = np.flatnonzero(corners.any(axis=1) & ~corners.all(axis=1))
        points, gone = taken(cut, (1 - 1 / PARTS[dim]) * _lattice(PARTS[dim], dim))
        left = (~gone).sum(axis=1)
        share[cut] = left / gone.shape[1]
        middle[cut] = (
            np.where(gone[..., None], 0.0, points).sum(axis=1) / np.maximum(left, 1)[:, None]
        )
        return np.column_stack([share, middle]).ravel()

    return remainder


def _lattice(number: int, dim: int) -> np.ndarray:
    """So many points along each side of the cell from -1/2 to 1/2, its corners among them."""
    along = np.linspace(-0.5, 0.5, number)
    return np.stack(np.meshgrid(*[along] * dim, indexing="ij"), axis=-1).reshape(-1, dim)


def _frames(normal: np.ndarray) -> np.ndarray:
    """Axes (N, dim, dim) of cells that lie along the ground, the last one its normal (N, dim)."""
    dim = normal.shape[1]
    along = np.zeros_like(normal)
    steeper = np.argmax(np.abs(normal[:, :-1]), axis=1)  # rows of cells run along this axis
    along[np.arange(len(normal)), steeper] = 1.0
    along -= (along * normal).sum(axis=1)[:, None] * normal
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = [np.cross(normal, along)] if dim == 3 else []
    return np.stack([along, *across, normal], axis=1)
