"""Bodies whose points are clamped: which ones are, and those of which none or all are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....util.finding import Finding
from ...bodies import ElasticBody
from ...kinds.body import Body


@dataclass(frozen=True)
class HoldsNone(Finding):
    """A body of which no point is clamped."""

    points: int
    low: float  # of the expression over them
    high: float

    def __str__(self) -> str:
        return (
            f"{self.place}: clamped holds none of its {self.points:,} points, at which it is from "
            f"{self.low:.4g} to {self.high:.4g}: a point is held where it is above 0; change the "
            "expression, or remove it from a body that is free"
        )


@dataclass(frozen=True)
class HoldsAll(HoldsNone):
    """A body that cannot move, nor break."""

    def __str__(self) -> str:
        return (
            f"{self.place}: clamped holds all of its {self.points:,} points, at which it is from "
            f"{self.low:.4g} to {self.high:.4g}, so that nothing moves or breaks: let it be above "
            "0 only where the body is held, or set fixed = true"
        )


def clamped_points(elastic: Sequence[ElasticBody], count: int) -> np.ndarray:
    """Mask (N,) of the clamped ones among `count` particles."""
    clamped = np.zeros(count, bool)
    for body in elastic:
        clamped[body.members[body.clamped]] = True
    return clamped


def clamp_findings(
    bodies: Mapping[str, Body[Any]], elastic: Sequence[ElasticBody]
) -> Iterator[Finding]:
    """One for each table of `bodies` whose expression holds nothing, or everything."""
    for name in dict.fromkeys(body.name for body in elastic):
        entry = bodies[name].table.given("clamped")
        if entry is None:
            continue
        mine = [body for body in elastic if body.name == name]
        held = np.concatenate([body.clamped for body in mine])
        if held.any() and not held.all():
            continue
        rest = np.concatenate([body.rest for body in mine])
        values = bodies[name].values_at("clamped", entry, rest)
        kind = HoldsAll if held.all() else HoldsNone
        yield kind(name, len(held), float(values.min()), float(values.max()))
