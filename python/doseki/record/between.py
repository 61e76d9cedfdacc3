"""The particles between two snapshots."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from .fields import FIELD_BY_KEY

Fields = Mapping[str, np.ndarray]


class Between(Mapping[str, np.ndarray]):
    """Particles at a time between two snapshots: a mapping like a Snapshot, without `grains`.

    It has the particles that are in both, in the order of the earlier one.  Floating-point fields
    are linear in time, along periodic axes the shorter way round; others are those of the earlier
    one.
    """

    def __init__(
        self,
        time: float,
        times: tuple[float, float],
        snapshots: tuple[Fields, Fields],
        periods: Sequence[tuple[int, float, float]] = (),
    ) -> None:
        """`times` of the `snapshots`, s, around `time`; `periods`: axis, low and high end, m."""
        self.time = time
        self._snapshots, self._periods = snapshots, periods
        self._share = (time - times[0]) / (times[1] - times[0])
        _, *self._rows = np.intersect1d(
            snapshots[0]["id"], snapshots[1]["id"], assume_unique=True, return_indices=True
        )
        order = np.argsort(self._rows[0])
        self._rows = [rows[order] for rows in self._rows]

    def __getitem__(self, key: str) -> np.ndarray:
        before, after = (s[key][rows] for s, rows in zip(self._snapshots, self._rows, strict=True))
        if key not in FIELD_BY_KEY or not np.issubdtype(before.dtype, np.floating):
            return before
        change = after - before
        if key != "position":
            return before + self._share * change
        for axis, low, high in self._periods:
            change[:, axis] -= (high - low) * np.round(change[:, axis] / (high - low))
        position = before + self._share * change
        for axis, low, high in self._periods:
            position[:, axis] = low + (position[:, axis] - low) % (high - low)
        return position

    def __iter__(self) -> Iterator[str]:
        return iter(self._snapshots[0])

    def __len__(self) -> int:
        return len(self._snapshots[0])
