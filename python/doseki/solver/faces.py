"""The faces of fixed bodies whose loads are read, cut into pieces as small as particles."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..scenario.gauges.gauge import FacesAt
from ..scenario.gauges.loads.load import Load
from ..scenario.model import Scenario
from ..scene.kinds.registry import body_of
from ..scene.moved import Displacement
from ..scene.periodic import wrapped


def faces_of(scenario: Scenario) -> Mapping[str, FacesAt]:
    """The faces of each table that a load gauge names, where its bodies have faces."""
    named = [gauge.bodies for gauge in scenario.gauge.values() if isinstance(gauge, Load)]
    found: dict[str, FacesAt] = {}
    for name in dict.fromkeys(name for bodies in named for name in bodies):
        if name not in scenario.body:
            continue
        corners = body_of(scenario, name).faces()
        if corners is not None:
            found[name] = _Moved(scenario, name, cut(corners, scenario.dp))
    return found


class _Moved:
    """Pieces of the faces of a body, which may move as is prescribed."""

    def __init__(self, scenario: Scenario, name: str, pieces: np.ndarray) -> None:
        self._scenario, self._name, self._pieces = scenario, name, pieces

    def __call__(self, time: float) -> np.ndarray:
        """Their corners (n, dim, dim), m, at a time, s."""
        dim = self._scenario.dim
        moved = Displacement(self._scenario, self._name, time).points(self._pieces.reshape(-1, dim))
        pieces = moved.reshape(-1, dim, dim)
        middle = pieces.mean(axis=1)
        return np.asarray(pieces + (wrapped(self._scenario, middle) - middle)[:, None])


def cut(corners: np.ndarray, longest: float) -> np.ndarray:
    """Segments (n, 2, 2) or triangles (n, 3, 3), m, halved until no side is longer than that."""
    done, pieces = [], corners
    while len(pieces):
        sides = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2)
        long = sides.max(axis=1) > longest
        done.append(pieces[~long])
        pieces = _halves(pieces[long], sides[long].argmax(axis=1))
    return np.concatenate([corners[:0], *done])


def _halves(pieces: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Both halves of each, which is divided at the middle of a side."""
    rows = np.arange(len(pieces))
    after = (side + 1) % pieces.shape[1]
    middle = 0.5 * (pieces[rows, side] + pieces[rows, after])
    first, second = pieces.copy(), pieces.copy()
    first[rows, after] = middle
    second[rows, side] = middle
    return np.concatenate([first, second])
