"""What is measured on a run: windows, speed histograms, fronts, masses.

Pure functions of numpy arrays.  Positions are (N, dim), velocities (N, dim), in SI units.
"""

from __future__ import annotations

import math

import numpy as np

TRACE = 1e-9  # of the mass of what breaks: less than that is nothing left


def to_frame(position: np.ndarray, rotate: float) -> np.ndarray:
    """Coordinates (N, dim) in axes turned by `rotate` degrees from the first towards the last."""
    turned = np.array(position, dtype=float)
    c, s = math.cos(math.radians(rotate)), math.sin(math.radians(rotate))
    turned[:, 0] = c * position[:, 0] + s * position[:, -1]
    turned[:, -1] = c * position[:, -1] - s * position[:, 0]
    return turned


def in_window(
    position: np.ndarray, lower: np.ndarray, upper: np.ndarray, rotate: float = 0.0
) -> np.ndarray:
    """Whether each particle is inside the box (lower, upper) of axes turned by `rotate` degrees."""
    turned = to_frame(position, rotate)
    return np.all((turned >= lower) & (turned <= upper), axis=1)


def filled_fraction(x: np.ndarray, start: float, end: float, cells: int = 10) -> float:
    """The share of `cells` equal parts of [start, end] that hold at least one of the points x."""
    counts, _ = np.histogram(x, bins=cells, range=(start, end))
    return np.count_nonzero(counts) / cells


def speed(velocity: np.ndarray) -> np.ndarray:
    """|v| of each particle."""
    return np.linalg.norm(velocity, axis=1)


def speed_edges(speeds: np.ndarray, bin_width: float = 0.1) -> np.ndarray:
    """Bin edges 0, w, 2w ... that hold all `speeds`, m/s; at least one bin."""
    highest = np.max(speeds, initial=0.0)
    return bin_width * np.arange(math.floor(highest / bin_width * (1 + 1e-12)) + 2)


def speed_histogram(speeds: np.ndarray, bin_width: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """(edges, counts) of `speeds` in bins of `bin_width` m/s from zero."""
    edges = speed_edges(speeds, bin_width)
    return edges, np.histogram(speeds, edges)[0]


def sampled_histogram(
    speeds: np.ndarray, edges: np.ndarray, size: int = 30, draws: int = 2000, seed: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Histograms of random samples of `size` particles: mean, 5 % and 95 % quantile per bin.

    The paper shows one sample of 30; many draws show how much such a sample varies.  Sampling is
    without replacement, from a fixed seed; fewer than `size` particles are all taken.
    """
    if len(speeds) == 0:
        nothing = np.zeros(len(edges) - 1)
        return nothing, nothing, nothing
    random = np.random.default_rng(seed)
    size = min(size, len(speeds))
    counts = np.array(
        [np.histogram(random.choice(speeds, size, replace=False), edges)[0] for _ in range(draws)]
    )
    low, high = np.quantile(counts, (0.05, 0.95), axis=0)
    return counts.mean(axis=0), low, high


def front(x: np.ndarray, direction: float) -> float:
    """The coordinate of the most advanced point when the flow runs along `direction` (+1, -1)."""
    return direction * float(np.max(direction * x)) if len(x) else math.nan


def mean_velocity(velocity: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Velocity (dim,) of the centre of mass; nan when there are no particles."""
    if len(mass) == 0:
        return np.full(velocity.shape[1], math.nan)
    return np.average(velocity, axis=0, weights=mass)


class PassedMass:
    """Mass that has crossed a section, from snapshots given in order of time.

    A particle that has been seen upstream counts as passed once it is not there any more: it is
    downstream, or an outflow has removed it.  It stays so where it falls back below the section.
    Where the direction of the flow is unknown a particle may come from either side; one that is
    removed does not count, since nothing says where.  What breaks takes its parts along: each has
    been where the whole was, and the whole counts with what is left of it.
    """

    def __init__(self, section: float, direction: int) -> None:
        """The section x = `section`, m; the flow runs along `direction`: +1, -1, or 0: unknown."""
        self._section = section
        # For each way in which it may be crossed: mass by id of what has still to do so.
        self._upstream: dict[int, dict[int, float]] = {
            way: {} for way in ([direction] if direction else [-1, 1])
        }
        self._passed: dict[int, float] = {}

    @property
    def count(self) -> int:
        """How many particles have passed so far."""
        return sum(mass > 0 for mass in self._passed.values())

    def update(
        self, x: np.ndarray, mass: np.ndarray, ids: np.ndarray, source: np.ndarray | None = None
    ) -> float:
        """Take one snapshot of what counts; returns the mass passed so far, kg (2-D: kg/m).

        `source` (n,) is the id that each had, or was part of, in the snapshot before.
        """
        seen = dict(zip(ids.tolist(), mass.tolist(), strict=True))
        parts = _parts(ids, ids if source is None else source)
        lost: dict[int, float] = {}  # by what has broken: mass of what came off it
        for part, whole in parts.items():
            lost[whole] = lost.get(whole, 0.0) + seen[part]
        self._passed |= {part: 0.0 for part, whole in parts.items() if whole in self._passed}
        for way, waiting in self._upstream.items():
            there = set(ids[way * (x - self._section) < 0].tolist())
            can_vanish = len(self._upstream) == 1
            waiting |= {part: seen[part] for part, whole in parts.items() if whole in waiting}
            gone = {
                i: seen.get(i, m - lost.get(i, 0.0))
                for i, m in waiting.items()
                if i not in there and (can_vanish or i in seen)
            }
            self._passed |= {i: m for i, m in gone.items() if m > TRACE * waiting[i]}
            self._upstream[way] = {i: seen[i] for i in there if i not in self._passed}
        return math.fsum(self._passed.values())


def _parts(ids: np.ndarray, source: np.ndarray) -> dict[int, int]:
    """By the id of what has just come off something: the id of that."""
    new = (source >= 0) & (source != ids)
    return dict(zip(ids[new].tolist(), source[new].tolist(), strict=True))
