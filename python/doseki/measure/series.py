"""Numbers read from a series, as a pressure over time: peak, arrival, impulse.

Times (n,) rise, s; values (n,) have any unit.  Between samples a series is a straight line.
"""

from __future__ import annotations

import numpy as np

SHARE = 0.25  # of its peak: where a pressure is said to arrive


def peak(times: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """The highest value, and when it is first there.

    Of an unfiltered pressure this is no quantity: it changes with the last digit of a run, and
    need not fall as particles become smaller.  Filter it first (util.low_pass).
    """
    k = int(np.argmax(values))
    return float(values[k]), float(times[k])


def arrival(times: np.ndarray, values: np.ndarray, share: float = SHARE) -> float:
    """When a series first has a share of its peak, s; nan where it has no peak above zero."""
    highest = float(np.max(values))
    return first_above(times, values, share * highest) if highest > 0 else float("nan")


def impulse(times: np.ndarray, values: np.ndarray, start: float, end: float) -> float:
    """Integral of a series between two times, unit times s; level beyond its ends."""
    inside = (times > start) & (times < end)
    t = np.concatenate([[start], times[inside], [end]])
    v = np.interp(t, times, values)
    return float(np.sum(0.5 * (v[1:] + v[:-1]) * np.diff(t)))


def first_above(times: np.ndarray, values: np.ndarray, level: float) -> float:
    """When a series first reaches a level, s; nan if it never does."""
    above = np.flatnonzero(values >= level)
    if not len(above):
        return float("nan")
    k = int(above[0])
    if k == 0:
        return float(times[0])
    share = (level - values[k - 1]) / (values[k] - values[k - 1])
    return float(times[k - 1] + share * (times[k] - times[k - 1]))
