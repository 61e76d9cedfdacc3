"""Gaps between upright faces in which a film of water has the wrong pressure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....scenario.model import Scenario
from ....scenario.schemes import RESOLVED
from ....util.finding import Finding
from ...groups import Group
from ...meeting import meeting_pairs
from ..groups import Block, blocks_of

NARROW, WIDE = 0.2, 0.75  # spacings: between them the film loses its pressure towards the bed
OPPOSITE = 0.98  # minus the cosine between normals of faces that look at each other
UPRIGHT = 0.7  # cosine between the normal of an upright face and gravity, at most


@dataclass(frozen=True)
class NarrowGap(Finding):
    """Two bodies with upright faces a part of a spacing apart, of which one moves."""

    other: str
    gap: float  # m
    spacing: float  # m

    def __str__(self) -> str:
        return (
            f"{self.place}: an upright face of it is {self.gap:.3g} m from one of {self.other}, "
            f"{self.gap / self.spacing:.2g} dp: under water the film in gaps of {NARROW:g} to "
            f"{WIDE:g} dp loses its pressure, so that both hardly have uplift and are pressed "
            "together; let them touch, or leave a gap of a dp"
        )


def gap_findings(scenario: Scenario, groups: list[Group]) -> Iterator[Finding]:
    """One finding for each two bodies that move, or one and a fixed one, with such a gap."""
    gravity = np.asarray(scenario.gravity)
    has_films = scenario.scheme == RESOLVED and scenario.uplift and scenario.liquids
    if not has_films or not gravity.any():
        return
    blocks = [b for group in groups if not group.elastic for b in blocks_of(group, scenario)]
    if not blocks:
        return
    low, high = (
        np.array([end(b.corners, axis=(0, 1)) for b in blocks]) for end in (np.min, np.max)
    )
    down, reach = gravity / np.linalg.norm(gravity), WIDE * scenario.dp
    told = set[tuple[str, str]]()
    for first, second in meeting_pairs(low - 0.5 * reach, high + 0.5 * reach):
        one, other = blocks[first], blocks[second]
        if one.fixed:
            one, other = other, one
        names = one.name, other.name
        if one.fixed or names in told:
            continue
        gap, normal = _gap(one, other)
        if NARROW * scenario.dp < gap < reach and abs(normal @ down) < UPRIGHT:
            told.add(names)
            yield NarrowGap(f"body.{names[0]}", names[1], gap, scenario.dp)


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
