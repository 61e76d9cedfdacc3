"""What several pages read from a record."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from doseki.measure.loads import BodyLoad, body_loads
from doseki.record.reader import Run, Snapshot


def parameter(run: Run, name: str) -> float:
    """The value of a parameter of the run's scenario, SI units."""
    return float(run.scenario["parameters"][name]["value"])


def over_time(run: Run, of: Callable[[Snapshot], Any]) -> np.ndarray:
    """A quantity of each snapshot (T, ...)."""
    return np.array([of(snapshot) for snapshot in run])


def moving(snapshot: Snapshot, name: str, kind: str = "material") -> np.ndarray:
    """Which particles (N,) move and are of a material (or `kind` = "body") of that name."""
    return ~snapshot["fixed"] & (snapshot[kind] == name)


def load_on(run: Run, gauge: str) -> BodyLoad:
    """What the gauge of kind load of that name has seen."""
    return next(load for load in body_loads(run) if load.name == gauge)


def first_time(time: np.ndarray, there: np.ndarray) -> float:
    """The first of `time` (n,) at which `there` (n,) holds, s; nan if it never does."""
    return float(time[there][0]) if there.any() else float("nan")
