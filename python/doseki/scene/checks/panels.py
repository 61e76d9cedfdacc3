"""Checks of panels, which must lie on the walls that they are named on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...record.particles import FIXED, ParticleSet
from ...scenario.gauges.gauge import Setting, State
from ...scenario.gauges.loads.panels import Panels
from ...scenario.model import Scenario
from ...util.finding import Finding
from ..ground import ground_of

LEAST = 0.6  # share of a panel that is wall: edges of bodies do not meet whole particles
NEAR = (
    0.87  # spacings from a place at which a wall is still there: inside a lattice, none is farther
)
LOST = 0.4  # spacings of the width of a panel, whose load is missing at an edge, at most
NAMED = 8  # panels, at most, in a sentence


@dataclass(frozen=True)
class PanelsAtEdges(Finding):
    """Panels at edges of a face, where wall particles bear less than the pressure."""

    panels: tuple[int, ...]
    of: int
    most: float  # share of the pressure that one of them lacks, at most

    def __str__(self) -> str:
        names = ", ".join(str(panel) for panel in self.panels[:NAMED])
        more = ", ..." if len(self.panels) > NAMED else ""
        return (
            f"{self.place}: {len(self.panels)} of {self.of} panels lie at an edge of the face or "
            f"at another wall ({names}{more}), where its particles bear less than the pressure: "
            f"they read up to {100 * self.most:.0f} % low, in still water too; that is {LOST:g} dp "
            "of their width at each such edge, so that larger panels or a smaller dp make it less"
        )


def check_panels(
    scenario: Scenario, particles: ParticleSet, names: list[str], walls: State
) -> None:
    """Raise UserError for a panel that is not wall; `walls` has normal and depth of particles."""
    setting = scenario.setting(names)
    state = {**vars(particles), **walls}
    for name, gauge in scenario.gauge.items():
        if not isinstance(gauge, Panels):
            continue
        covered = gauge.covered(state, setting)
        worst = int(np.argmin(covered))
        if covered.max() < LEAST:
            raise scenario.where.error(
                ("gauge", name, "origin"),
                f"gauge.{name}.origin = {gauge.origin.tolist()}: no surface of "
                f"{', '.join(gauge.bodies)} lies in the plane of the panels and faces "
                f"{gauge.direction.tolist()}",
            )
        if covered[worst] < LEAST:
            raise scenario.where.error(
                ("gauge", name, "edges"),
                f"gauge.{name}.edges reach beyond the face: {100 * covered[worst]:.0f} % of panel "
                f"{worst} is wall",
            )


def panel_findings(
    scenario: Scenario, particles: ParticleSet, names: list[str], normal: np.ndarray,
    depth: np.ndarray,
) -> Iterator[Finding]:  # fmt: skip
    """Names the panels that lie at edges."""
    setting = scenario.setting(names)
    state = {**vars(particles), "normal": normal, "depth": depth}
    for name, gauge in scenario.gauge.items():
        if not isinstance(gauge, Panels):
            continue
        ends = np.zeros((int(np.prod(gauge.panels)), len(gauge.size)))
        for axis in range(len(gauge.size)):
            for side in (-1, 1):
                beyond = gauge.beside(axis, side, 0.5 * scenario.dp)
                ends[:, axis] += _is_edge(scenario, state, gauge, beyond, setting)
        left = np.prod(np.maximum(0.0, 1 - LOST * scenario.dp * ends / gauge.size), axis=1)
        edge = np.flatnonzero(left < 1)
        if len(edge):
            found = tuple(edge.tolist()), len(left), float(1 - left.min())
            yield PanelsAtEdges(f"gauge.{name}.panels", *found)


def _is_edge(
    scenario: Scenario, state: State, gauge: Panels, beyond: np.ndarray, setting: Setting
) -> np.ndarray:
    """Whether a face does not go on at points (n, dim) of its plane, or another wall covers it."""
    from scipy.spatial import cKDTree

    away = state["position"][gauge.first_row(state, setting)] - gauge.origin
    face = gauge.origin + away - np.outer(away @ gauge.normal, gauge.normal)
    near = NEAR * scenario.dp
    edge = np.asarray(cKDTree(face).query(beyond)[0] > near)
    before = beyond + 0.5 * scenario.dp * gauge.normal
    others = (state["motion"] == FIXED) & ~setting.is_of_bodies(gauge.bodies, state)
    if others.any():
        edge |= cKDTree(state["position"][others]).query(before)[0] < near
    if scenario.bed is not None:
        edge |= ground_of(scenario.bed).height_above(before) < 0
    return edge
