"""Gaps beside bodies under water that are too narrow for a particle, where the uplift is rough."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import factorial

import numpy as np

from ....scenario.model import Scenario
from ....scenario.schemes import RESOLVED
from ....util.finding import Finding
from ...groups import Group
from ...meeting import meeting_pairs
from ..groups import Block, blocks_of

NARROW, WIDE = 0.2, 0.75  # spacings: a film, or one column of particles that rattles
ERROR = 0.7  # spacings: the uplift is off by the pressure at the foot on a strip so wide, or less
NEAR = 4.0  # spacings around a body, in which the water is that it stands in
MUCH = 0.15  # of the uplift
OPPOSITE = 0.98  # minus the cosine between normals of faces that look at each other
UPRIGHT = 0.7  # cosine between the normal of an upright face and gravity, at most


@dataclass(frozen=True)
class NarrowGap(Finding):
    """A body that moves, with an upright face a part of a spacing away from that of another."""

    other: str
    gap: float  # m
    spacing: float  # m
    head: float  # m, of water above its foot
    error: float  # of its uplift

    def __str__(self) -> str:
        return (
            f"{self.place}: an upright face of it is {self.gap:.3g} m from one of {self.other}, "
            f"{self.gap / self.spacing:.2g} dp: under {self.head:.3g} m of water the film in so "
            f"narrow a gap may put its uplift wrong by {100 * self.error:.0f} %; let them touch, "
            "leave a gap of a dp, or take a smaller dp"
        )


def gap_findings(scenario: Scenario, groups: list[Group], water: np.ndarray) -> Iterator[NarrowGap]:
    """One finding for each body and another beside it; `water`: places (n, dim) of the fluid, m."""
    gravity = np.asarray(scenario.gravity)
    has_films = scenario.scheme == RESOLVED and scenario.uplift and len(water) > 0
    if not has_films or not gravity.any():
        return
    blocks = [b for group in groups if not group.elastic for b in blocks_of(group, scenario)]
    up = -gravity / np.linalg.norm(gravity)
    told = set[tuple[str, str]]()
    for one, other, gap in _gaps(blocks, up, WIDE * scenario.dp):
        for block, beside in ((one, other), (other, one)):
            names = block.name, beside.name
            if block.fixed or names in told or not NARROW * scenario.dp < gap:
                continue
            head = _head(block, water, up, scenario.dp)
            error = ERROR * scenario.dp * head * _length(block, up) / _measure(block)
            if error > MUCH:
                told.add(names)
                yield NarrowGap(f"body.{names[0]}", names[1], gap, scenario.dp, head, error)


def _gaps(
    blocks: list[Block], up: np.ndarray, reach: float
) -> Iterator[tuple[Block, Block, float]]:
    """Pairs of which upright faces are nearer than `reach`, m, and how near."""
    if not blocks:
        return
    low, high = (
        np.array([end(b.corners, axis=(0, 1)) for b in blocks]) for end in (np.min, np.max)
    )
    for first, second in meeting_pairs(low - 0.5 * reach, high + 0.5 * reach):
        one, other = blocks[first], blocks[second]
        if one.fixed and other.fixed:
            continue
        gap, normal = _gap(one, other)
        if gap < reach and abs(normal @ up) < UPRIGHT:
            yield one, other, gap


def _gap(one: Block, other: Block) -> tuple[float, np.ndarray]:
    """How far apart two are along a normal that both have, m, and that; -inf where none has it."""
    best, along = -np.inf, np.zeros(one.normal.shape[1])
    for near, far in ((one, other), (other, one)):
        apart = (far.corners @ near.normal.T).min(axis=(0, 1)) - near.offset
        faces = (near.normal @ far.normal.T).min(axis=1) < -OPPOSITE
        apart = np.where(faces, apart, -np.inf)
        if apart.max() > best:
            best, along = float(apart.max()), near.normal[apart.argmax()]
    return best, along


def _head(block: Block, water: np.ndarray, up: np.ndarray, dp: float) -> float:
    """Of the water around it, above its foot, m; 0 where there is none."""
    apart = water - block.centre
    aside = np.linalg.norm(apart - np.outer(apart @ up, up), axis=1)
    near = water[aside < block.reach + NEAR * dp]
    top = float((near @ up).max(initial=-np.inf)) + 0.5 * dp
    return max(0.0, top - float((block.corners @ up).min()))


def _measure(block: Block) -> float:
    """Its area, m2, or volume, m3: that of the simplices from its middle to its sides."""
    spans = block.corners - block.centre
    return float(np.abs(np.linalg.det(spans)).sum()) / factorial(spans.shape[-1])


def _length(block: Block, up: np.ndarray) -> float:
    """Of a gap along its foot: 1 in 2-D, else a mean of how long it is across, m."""
    if len(up) == 2:
        return 1.0
    height = np.ptp(block.corners @ up)
    return float(np.sqrt(_measure(block) / height))
