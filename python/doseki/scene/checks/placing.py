"""Gauges and fixed bodies that a flow on a terrain does not get to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...record.particles import FIXED, ParticleSet
from ...scenario.bed import Bed
from ...scenario.gauges.gauge import Gauge
from ...scenario.gauges.loads.approach import Approach
from ...scenario.gauges.section import Section
from ...scenario.gauges.surface_height import SurfaceHeight
from ...scenario.model import Scenario
from ...util.finding import Finding
from ..ground import ground_of

GAP = 3.0  # spacings between the foot of a column and what it begins with (near.column_height)
OFF = 0.5  # spacings, from which on heights are told to begin elsewhere


@dataclass(frozen=True)
class BesideMap(Finding):
    """A gauge or a body where the map says nothing."""

    def __str__(self) -> str:
        return (
            f"{self.place}: lies beyond the terrain, or where it has no data, so nothing comes by"
        )


@dataclass(frozen=True)
class BankBesideMap(Finding):
    """A section that goes beyond the map."""

    bank: str  # left or right
    at: tuple[float, float]  # m

    def __str__(self) -> str:
        return (
            f"{self.place}: its {self.bank} bank [{self.at[0]:.10g}, {self.at[1]:.10g}] lies "
            "beyond the terrain, or where it has no data: nothing passes there"
        )


@dataclass(frozen=True)
class OffBed(Finding):
    """A gauge whose column does not begin on the bed."""

    above: float  # m; below 0: in the ground
    level: float  # z of the bed, m
    misses: bool  # the flow

    def __str__(self) -> str:
        side = "above" if self.above > 0 else "below"
        told = "it misses the flow" if self.misses else "its heights count from there"
        return (
            f"{self.place}: its position is {abs(self.above):.3g} m {side} the bed, so that "
            f"{told}; the bed is at {self.level:.6g} m there"
        )


@dataclass(frozen=True)
class Buried(Finding):
    """A fixed body below the ground."""

    def __str__(self) -> str:
        return f"{self.place}: all of it lies in the ground, where no flow gets to it"


def placing_findings(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> Iterator[Finding]:
    """A doubt about each fixed body and each gauge that the flow will not meet."""
    yield from _body_findings(scenario, particles, names)
    yield from _gauge_findings(scenario)


def _body_findings(
    scenario: Scenario, particles: ParticleSet, names: list[str]
) -> Iterator[Finding]:
    """Those of fixed bodies, `particles` of which are named by `names`."""
    bed = scenario.bed
    if bed is None:
        return
    fixed = particles.motion == FIXED
    for k, name in enumerate(names):
        position = particles.position[fixed & (particles.body == k)]
        if not len(position):
            continue
        ground = ground_of(bed).field.at(np.ascontiguousarray(position[:, :-1]))
        if ground["unknown"].all():
            yield BesideMap(f"body.{name}")
        elif (position[:, -1] < ground["height"]).all():
            yield Buried(f"body.{name}")


def _gauge_findings(scenario: Scenario) -> Iterator[Finding]:
    """Those of gauges that lie beside the map, or whose columns miss the bed."""
    bed = scenario.bed
    if bed is None:
        return
    for name, gauge in scenario.gauge.items():
        feet = _feet(gauge, scenario)
        if feet is not None:
            yield from _findings(f"gauge.{name}", gauge, feet, bed, scenario.dp)


def _feet(gauge: Gauge, scenario: Scenario) -> np.ndarray | None:
    """Places (n, dim or, of a section, dim - 1) that must be on the map; None for other kinds."""
    if isinstance(gauge, Section):
        ends = np.array([gauge.left, gauge.right], dtype=float)
        return ends[0] + np.linspace(0, 1, 101)[:, None] * (ends[1] - ends[0])
    if isinstance(gauge, Approach):
        return gauge.feet(scenario.setting())
    return gauge.position[None, :] if isinstance(gauge, SurfaceHeight) else None


def _findings(place: str, gauge: Gauge, feet: np.ndarray, bed: Bed, dp: float) -> Iterator[Finding]:
    """What is wrong at all of its places.  Columns of an approach find the bed."""
    across = bed.heights.ndim
    ground = ground_of(bed).field.at(np.ascontiguousarray(feet[:, :across]))
    if ground["unknown"].all():
        yield BesideMap(place)
    elif isinstance(gauge, Section):
        for bank, k in (("left", 0), ("right", -1)):
            if ground["unknown"][k]:
                yield BankBesideMap(place, bank, (float(feet[k, 0]), float(feet[k, 1])))
    elif isinstance(gauge, SurfaceHeight):
        level = float(ground["height"][0])
        above = float(feet[0, -1]) - level
        if abs(above) > OFF * dp:
            yield OffBed(place, above, level, abs(above) > GAP * dp)
