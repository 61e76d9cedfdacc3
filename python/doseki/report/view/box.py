"""The box that a view shows, and what of it matters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...figures.dots import ROOM, STRAY, ends_of_most, grain_radius
from ...record.reader import Run, Snapshot

FARTHEST = 10.0  # sizes of the flow: what is farther from it is left out
SAMPLES = 12  # snapshots that are looked at
THIN = 1e-3  # thickness of a flat scene over its size

Ends = tuple[np.ndarray, np.ndarray]  # lower and upper corner (dim,), m


@dataclass(frozen=True)
class Box:
    """Corners (3,) in m, map coordinates; a flat scene is `THIN` along the third axis.

    `focus` is what the picture shows at first: what moves, and walls nearby; `flow` is where most
    of what moves is: walls between it and the viewer are cut away.
    The corners of both count from that of the box.
    """

    corner: np.ndarray
    size: np.ndarray
    focus: Ends
    flow: Ends
    dim: int

    def share(self, position: np.ndarray) -> np.ndarray:
        """Places (n, dim) from 0 to 1 along each axis of the box."""
        d = self.dim
        share: np.ndarray = (position - self.corner[:d]) / self.size[:d]
        return share

    def holds(self, position: np.ndarray) -> np.ndarray:
        """Mask (n,) of what is in the box; not of what is not a number."""
        share = self.share(position)
        inside: np.ndarray = np.all((share >= 0) & (share <= 1), axis=1)
        return inside


def box_of(run: Run, drawn: Sequence[np.ndarray] = ()) -> Box:
    """The box around a run and other corners (dim,) that are drawn with it.

    Drops that fly far from all others are outside of it.
    """
    dim = run.scenario["dim"]
    step = max(1, len(run) // SAMPLES)
    samples = [*run[::step], run[-1]]
    low, high = _ends_of_flow(samples, dim, ends_of_most)
    most = _ends_of_flow(samples, dim, _without_strays)
    reach = FARTHEST * float(np.max(high - low))
    walls = _ends(samples[0], samples[0]["fixed"])
    all_low, all_high = low, high
    for snapshot in samples:
        ends = _ends(snapshot, np.ones(len(snapshot["id"]), bool))
        all_low = np.minimum(all_low, np.maximum(ends[0], low - reach))
        all_high = np.maximum(all_high, np.minimum(ends[1], high + reach))
    for corner in drawn:
        all_low, all_high = np.minimum(all_low, corner), np.maximum(all_high, corner)
    margin = _largest_radius(samples) or 1e-3 * float(np.max(all_high - all_low)) or 1.0
    low, high = low - margin, high + margin
    room = ROOM * float(np.max(high - low))
    focus = (
        np.minimum(low, np.maximum(walls[0], low - room)),
        np.maximum(high, np.minimum(walls[1], high + room)),
    )
    corner, size = all_low - margin, all_high - all_low + 2 * margin
    thickness = np.full(3 - dim, THIN * float(size.max()))

    def inside(end: np.ndarray) -> np.ndarray:
        return np.concatenate([end - corner, np.zeros(3 - dim)])

    return Box(
        np.concatenate([corner, np.zeros(3 - dim)]),
        np.concatenate([size, thickness]),
        (inside(focus[0]), inside(focus[1])),
        (inside(most[0] - margin), inside(most[1] + margin)),
        dim,
    )


def _ends_of_flow(
    samples: Sequence[Snapshot], dim: int, ends_of: Callable[[np.ndarray], Ends]
) -> Ends:
    """Lower and upper corner of what moves; of everything where nothing does."""
    for mask_of in (_moves, _all):
        ends = []
        for snapshot in samples:
            position = snapshot["position"][mask_of(snapshot)]
            position = position[np.isfinite(position).all(axis=1)]
            if len(position):
                ends.append(ends_of(position))
        if ends:
            return np.min([e[0] for e in ends], axis=0), np.max([e[1] for e in ends], axis=0)
    return np.zeros(dim), np.ones(dim)


def _without_strays(position: np.ndarray) -> Ends:
    low, high = np.percentile(position, (STRAY, 100 - STRAY), axis=0)
    return low, high


def _moves(snapshot: Snapshot) -> np.ndarray:
    return ~snapshot["fixed"]


def _all(snapshot: Snapshot) -> np.ndarray:
    return np.ones(len(snapshot["id"]), bool)


def _ends(snapshot: Snapshot, mask: np.ndarray) -> Ends:
    position = snapshot["position"][mask]
    position = position[np.isfinite(position).all(axis=1)]
    if not len(position):
        nothing = np.full(snapshot.dim, np.inf)
        return nothing, -nothing
    return position.min(axis=0), position.max(axis=0)


def _largest_radius(samples: Sequence[Snapshot]) -> float:
    return max((float(np.max(grain_radius(s), initial=0.0)) for s in samples), default=0.0)
