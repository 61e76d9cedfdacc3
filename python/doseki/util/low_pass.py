"""A causal low-pass filter of signals that are sampled at uneven times."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

DAMPING = math.sqrt(2.0)  # 2 zeta of Butterworth's filter of second order


class LowPass:
    """Butterworth's filter of second order, y'' + sqrt(2) w y' + w^2 (y - u) = 0, w = 2 pi f.

    Each step is the exact solution for a signal u that is a straight line between two samples, so
    steps of any length may follow one another.  It starts at rest at the first sample.  A slow
    signal comes late by sqrt(2)/w; a sine of the frequency f keeps 1/sqrt(2) of its amplitude.
    """

    def __init__(self, frequency: float) -> None:
        """`frequency` f, Hz, above 0."""
        self._omega = 2 * math.pi * frequency
        self._state: tuple[float, ...] = ()  # time, u, y, y'

    @property
    def value(self) -> float:
        """What it shows, in the unit of the signal; nan before the first sample."""
        return self._state[2] if self._state else math.nan

    @property
    def state(self) -> list[float]:
        """What must be kept to go on; empty before the first sample."""
        return list(self._state)

    @state.setter
    def state(self, state: Iterable[float]) -> None:
        self._state = tuple(state)

    def add(self, time: float, signal: float) -> float:
        """Takes a sample, s and any unit, and returns what the filter shows then."""
        if not self._state:
            self._state = time, signal, signal, 0.0
            return signal
        before, u, y, rate = self._state
        dt = time - before
        if dt > 0.0:
            y, rate = self._step(dt, u, (signal - u) / dt, y, rate)
        self._state = time, signal, y, rate
        return y

    def _step(self, dt: float, u: float, slope: float, y: float, rate: float) -> tuple[float, ...]:
        """What is left of the distance to the line that y tends to decays as it turns."""
        a, lag = self._omega / DAMPING, DAMPING / self._omega * slope
        z, dz = y - u + lag, rate - slope
        decay, c, s = math.exp(-a * dt), math.cos(a * dt), math.sin(a * dt)
        new = u + slope * dt - lag + decay * (z * c + (dz / a + z) * s)
        return new, slope + decay * (dz * c - (dz + 2 * a * z) * s)


def low_passed(times: np.ndarray, signal: np.ndarray, frequency: float) -> np.ndarray:
    """What the filter of `frequency`, Hz, shows at the samples (n,) of a signal, at times (n,), s.

    Times must not fall.  For records of instruments and of gauges, so that both have one bandwidth.
    """
    filter_ = LowPass(frequency)
    pairs = zip(times.tolist(), signal.tolist(), strict=True)
    return np.array([filter_.add(time, value) for time, value in pairs])
