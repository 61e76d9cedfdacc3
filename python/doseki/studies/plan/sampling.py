"""The points of a study: a grid, a Latin hypercube, or a Sobol sequence."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Sequence

import numpy as np

from .axes import Axis, Value
from .tables import Sample

Point = tuple[Value, ...]  # a value for each axis


def points(axes: Sequence[Axis], sample: Sample) -> list[Point]:
    """The points at which runs are made, in the order of the sample, none twice.

    A grid has the last axis run fastest. The others divide each axis into shares: what is a list
    of values has equally many of each, to rounding.
    """
    if sample.kind == "grid":
        return list(dict.fromkeys(itertools.product(*(axis.grid() for axis in axes))))
    assert sample.count is not None
    shares = _shares(sample.kind, len(axes), sample.count, sample.seed or 0)
    rows = [tuple(axis.at(float(u)) for axis, u in zip(axes, row, strict=True)) for row in shares]
    return list(dict.fromkeys(rows))


def grid_size(axes: Sequence[Axis]) -> int:
    """How many points a grid has."""
    return math.prod(len(axis.choices) or (axis.count or 1) for axis in axes)


def _shares(kind: str, dimensions: int, count: int, seed: int) -> np.ndarray:
    """Points (count, dimensions) in the unit cube, the same for the same seed."""
    # Importing it takes as long as all the rest, and the processes of runs need it not.
    from scipy.stats import qmc

    random = np.random.default_rng(seed)
    if kind == "latin_hypercube":
        return qmc.LatinHypercube(dimensions, seed=random).random(count)
    with warnings.catch_warnings():
        # A count that is no power of two is told in other words; see `remarks`.
        warnings.simplefilter("ignore", UserWarning)
        return qmc.Sobol(dimensions, scramble=True, seed=random).random(count)


def remarks(sample: Sample) -> list[str]:
    """What is to be said of a sample."""
    count = sample.count or 0
    if sample.kind != "sobol" or count & (count - 1) == 0:
        return []
    return [
        f"a Sobol sequence is balanced for powers of two: sample.count = {1 << count.bit_length()}"
        f" in place of {count} would be"
    ]
