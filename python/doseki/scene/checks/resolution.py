"""Warnings about bodies that have too few particles across."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ...scenario.materials import NO_FRACTURE
from ...util.finding import Finding, no_more_than
from ..groups import Group
from ..kinds.body import Body

MIN_ACROSS = 5  # particles; below, a body is not resolved
MIN_ACROSS_ELASTIC = 2  # particles; fewer do not span an elastic body


@dataclass(frozen=True)
class CoarseBody(Finding):
    """A body that has too few particles across for the flow around it."""

    across: float  # particles
    spacing: float  # m

    def __str__(self) -> str:
        enough = self.across * self.spacing / MIN_ACROSS
        return (
            f"{self.place}: {self.across:.2g} particles across its bodies; below {MIN_ACROSS} the "
            f"flow around them is not resolved: dp = {no_more_than(enough)} "
            'would do, or kinematics = "single"'
        )


@dataclass(frozen=True)
class CoarseElasticBody(Finding):
    """An elastic body that has too few particles across to bend as it should."""

    across: float  # particles

    def __str__(self) -> str:
        return (
            f"{self.place}: {self.across:.2g} particles across an elastic body; below {MIN_ACROSS} "
            "it bends by a tenth too easily or more: make dp smaller"
        )


@dataclass(frozen=True)
class TouchesAsBalls(Finding):
    """A body in space that breaks and may touch others."""

    def __str__(self) -> str:
        return (
            f"{self.place}: bodies that break touch as layers of balls of one spacing in 3-D: what "
            "meets them at a slant to their particles is turned aside, by up to 28 % of its speed "
            "where smooth spheres meet head-on, at any dp; give it velocities along an axis, or "
            "look at it in 2-D, where surfaces are smooth"
        )


def resolution_warnings(bodies: Mapping[str, Body[Any]], groups: list[Group]) -> Iterator[Finding]:
    """One for each of the bodies that has too few particles across.

    Raises UserError for an elastic body that its particles do not span.
    """
    for group in groups:
        if group.fixed or group.single:
            continue
        body = bodies[group.name]
        across = min(shape.width for shape in group.shapes) / body.spacing
        if group.deforms:
            yield from _elastic_warnings(body, across)
            breaks = body.scenario.materials[body.table.material].fracture != NO_FRACTURE
            if breaks and body.dim == 3 and sum(len(one) for one in groups if not one.fixed) > 1:
                yield TouchesAsBalls(group.name)
        elif across < MIN_ACROSS - 1e-6:
            yield CoarseBody(group.name, across, body.spacing)


def _elastic_warnings(body: Body[Any], across: float) -> Iterator[Finding]:
    if across < MIN_ACROSS_ELASTIC - 1e-6:
        raise body.error(
            f": {across:.2g} particles across an elastic body; it needs at least "
            f"{MIN_ACROSS_ELASTIC}: make dp smaller"
        )
    if across < MIN_ACROSS - 1e-6:
        yield CoarseElasticBody(body.name, across)
