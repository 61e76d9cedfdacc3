"""What stands in an outflow at the start."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...record.particles import FREE, ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.region import Outflow
from ...util.finding import Finding
from ..groups import Group


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
