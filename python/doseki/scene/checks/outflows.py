"""Outflows that hold something at the start, and what lies far from everything."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...record.particles import FREE, ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.mesh import Mesh
from ...scenario.tables.region import Outflow
from ...util.finding import Finding
from ..groups import Group

FAR = 10.0  # times the size of everything else


@dataclass(frozen=True)
class LeavesAtOnce(Finding):
    """A body that an outflow holds, or a part of one."""

    body: str
    inside: int
    all: int
    what: str  # they are

    def __str__(self) -> str:
        part = f"{self.inside:,} of the {self.all:,} {self.what} of {self.body} start"
        said = f"all of {self.body} starts" if self.inside == self.all else part
        return f"{self.place}: {said} inside it and will leave at once: move one of the two"


@dataclass(frozen=True)
class FarAway(Finding):
    """What lies so far from the rest that hardly anything gets there, or from there."""

    gap: float  # m
    size: float  # m, of the rest

    def __str__(self) -> str:
        return (
            f"{self.place}: lies {self.gap:.3g} m from everything else, which is {self.size:.3g} m "
            "across: look at its coordinates"
        )


def far_findings(scenario: Scenario, particles: ParticleSet, names: list[str]) -> Iterator[Finding]:
    """A doubt about each outflow and each body of triangles that is far from all else."""
    ground = [] if scenario.bed is None else list(scenario.bed.corners)
    fixed_places = [*ground, *(inflow.position for inflow in scenario.inflow.values())]
    for name, outflow in scenario.outflow.items():
        everything = np.concatenate([particles.position, *(x[None] for x in fixed_places)])
        yield from _far(f"outflow.{name}", outflow.min, outflow.max, everything)
    for name, body in scenario.body.items():
        if not isinstance(body, Mesh):
            continue
        own = np.isin(particles.body, [names.index(n) for n in scenario.names_of_bodies(name)])
        rest = np.concatenate([particles.position[~own], *(x[None] for x in fixed_places)])
        mine = particles.position[own]
        if len(mine):
            yield from _far(f"body.{name}", mine.min(axis=0), mine.max(axis=0), rest)


def _far(place: str, low: np.ndarray, high: np.ndarray, rest: np.ndarray) -> Iterator[Finding]:
    if not len(rest):
        return
    near, far = rest.min(axis=0), rest.max(axis=0)
    gap = float(np.linalg.norm(np.maximum(0.0, np.maximum(low - far, near - high))))
    size = float(np.linalg.norm(far - near))
    if gap > FAR * size:
        yield FarAway(place, gap, size)


def outflow_findings(
    scenario: Scenario, particles: ParticleSet, names: list[str], groups: Sequence[Group]
) -> Iterator[Finding]:
    """A doubt about each outflow and each body of which something starts inside it."""
    for name, outflow in scenario.outflow.items():
        place = f"outflow.{name}"
        inside = _holds(outflow, particles.position)
        free = particles.motion == FREE
        for body in np.unique(particles.body[free & inside]):
            of_it = free & (particles.body == body)
            count = int((of_it & inside).sum())
            yield LeavesAtOnce(place, names[body], count, int(of_it.sum()), "particles")
        for group in groups:
            count = int(_holds(outflow, group.centre).sum())
            if count and not _stays(scenario, group):
                yield LeavesAtOnce(place, group.name, count, len(group), "bodies")


def _stays(scenario: Scenario, group: Group) -> bool:
    """Whether no outflow takes it."""
    body = scenario.body.get(group.name)
    return group.fixed or (body is not None and body.given("clamped") is not None)


def _holds(outflow: Outflow, position: np.ndarray) -> np.ndarray:
    return np.all((position >= outflow.min) & (position <= outflow.max), axis=1)
