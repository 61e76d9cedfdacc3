"""Calibration: a global optimiser of scipy looks for the values whose run is nearest to what was
observed. Each evaluation is a run of the study, kept and never made twice.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy.optimize import OptimizeResult, differential_evolution, dual_annealing, shgo

from .plan.axes import Axis
from .plan.sampling import Point
from .plan.tables import Calibrate
from .runs.row import DONE, Row

WORST = 1e10  # score of a run that has none; optimisers want numbers
POPULATION = 8
TOLERANCE = 0.05
GENERATIONS = 1_000_000  # which max_runs ends earlier
SIMPLEX = {"method": "Nelder-Mead", "options": {"xatol": 1e-3, "fatol": 1e-3}}


class Rows(Protocol):
    """What gives a row for each point, as runs.evaluation.Evaluation."""

    def rows(self, points: Sequence[Point]) -> list[Row]:
        """In their order."""


@dataclass(frozen=True)
class Calibration:
    """Where the score is least.

    Attributes:
        point: the values, one for each axis; None where no run has a score.
        score: there.
        runs: how many different ones were looked at.
        sampled: how many of these were those of a sample, which max_runs does not count.
        converged: whether the optimiser ended by itself, before max_runs.
        message: what it says.

    """

    point: Point | None
    score: float
    runs: int
    sampled: int
    converged: bool
    message: str


class _SpentError(Exception):
    """As many runs as were allowed have been looked at."""


class _Scores:
    """Scores of points of the unit cube, as many runs at once as are asked for together."""

    def __init__(self, axes: Sequence[Axis], source: Rows, most: int) -> None:
        self._axes, self._source, self._most = axes, source, most
        self.seen: dict[Point, float] = {}

    def of(self, shares: Iterable[np.ndarray]) -> list[float]:
        """Scores of points (n, axes); raises _SpentError when there were `most` runs."""
        asked = [self._point(share) for share in shares]
        new = [point for point in dict.fromkeys(asked) if point not in self.seen]
        room = self._most - len(self.seen)
        allowed = new[:room]
        if allowed:
            rows = self._source.rows(allowed)
            self.seen |= {point: score_of(row) for point, row in zip(allowed, rows, strict=True)}
        if len(new) > room:
            raise _SpentError
        return [self.seen[point] for point in asked]

    def one(self, share: np.ndarray) -> float:
        """The score of one point."""
        return self.of([share])[0]

    def columns(self, shares: np.ndarray) -> np.ndarray:
        """Scores (n,) of points (axes, n), as `vectorized` has them."""
        return np.array(self.of(np.atleast_2d(shares.T)))

    def mapped(self, _function: Callable[..., Any], shares: Iterable[np.ndarray]) -> list[float]:
        """Like `map`, for optimisers that evaluate several points at once."""
        return self.of(list(shares))

    def _point(self, share: np.ndarray) -> Point:
        return tuple(axis.at(float(u)) for axis, u in zip(self._axes, share, strict=True))


def score_of(row: Row) -> float:
    """The score of a run, a bad one where it has none."""
    return row.score if row.status == DONE and math.isfinite(row.score) else WORST


def calibrated(
    axes: Sequence[Axis], source: Rows, how: Calibrate, before: Sequence[Point] = ()
) -> Calibration:
    """Search all axes; the points `before` of a sample, beyond max_runs, may be the best, too."""
    start = dict(zip(before, map(score_of, source.rows(before)), strict=True)) if before else {}
    scores = _Scores(axes, source, how.max_runs + len(start))
    scores.seen |= start
    try:
        found = METHODS[how.method](len(axes), scores, how)
        converged, message = bool(found.success), str(np.squeeze(found.message))
    except _SpentError:
        converged, message = False, f"max_runs = {how.max_runs} were made"
    point = min(scores.seen, key=lambda each: scores.seen[each], default=None)
    best = math.nan if point is None else scores.seen[point]
    if best >= WORST:
        point, best = None, math.nan
    words = " ".join(message.split())
    return Calibration(point, best, len(scores.seen), len(start), converged, words)


def _evolved(dimensions: int, scores: _Scores, how: Calibrate) -> OptimizeResult:
    """Storn & Price (1997): generations whose runs do not wait for each other."""
    from scipy.stats import qmc

    random = np.random.default_rng(how.seed or 0)
    size = how.population or POPULATION
    first = qmc.LatinHypercube(dimensions, seed=random).random(size)
    tolerance = how.tolerance or TOLERANCE

    def small(intermediate_result: OptimizeResult) -> bool:
        """Whether the population lies within the tolerance on all axes."""
        spread = np.ptp(intermediate_result.population, axis=0)
        return bool(np.all(spread <= tolerance))

    found = differential_evolution(
        scores.columns, [(0.0, 1.0)] * dimensions, init=first, seed=random, tol=0.0, atol=0.0,
        maxiter=GENERATIONS, polish=False, updating="deferred", vectorized=True, callback=small,
    )  # fmt: skip
    found.success = True  # it ended by the population, or raised
    found.message = f"the population lies within {tolerance:g} of each range"
    return found


def _annealed(dimensions: int, scores: _Scores, how: Calibrate) -> OptimizeResult:
    """Generalised simulated annealing: one run after the other."""
    return dual_annealing(
        scores.one, [(0.0, 1.0)] * dimensions, seed=np.random.default_rng(how.seed or 0),
        maxiter=GENERATIONS, minimizer_kwargs=SIMPLEX,
    )  # fmt: skip


def _homologous(dimensions: int, scores: _Scores, how: Calibrate) -> OptimizeResult:
    """Simplicial homology (Endres et al. 2018), refined by simplices: no derivatives of noise."""
    return shgo(
        scores.one, [(0.0, 1.0)] * dimensions, n=max(4, how.max_runs // 3), sampling_method="sobol",
        minimizer_kwargs=SIMPLEX, workers=scores.mapped,
    )  # fmt: skip


METHODS: dict[str, Callable[[int, _Scores, Calibrate], OptimizeResult]] = {
    "differential_evolution": _evolved,
    "dual_annealing": _annealed,
    "shgo": _homologous,
}
