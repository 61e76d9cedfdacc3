"""Checks of panels, which must lie on the walls that they are named on."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.gauges.gauge import State
from ...scenario.gauges.loads.panels import Panels
from ...scenario.model import Scenario

LEAST = 0.5  # share of a panel that is wall, however small the panel
MISSING = 1.0  # spacings along an edge that need not be wall: bodies consist of whole particles
ROUNDING = 1e-9


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
        least = _least_covered(gauge, scenario.dp)
        worst = int(np.argmin(covered - least))
        if covered.max() < LEAST:
            raise scenario.where.error(
                ("gauge", name, "origin"),
                f"gauge.{name}.origin = {gauge.origin.tolist()}: no surface of "
                f"{', '.join(gauge.bodies)} lies in the plane of the panels and faces "
                f"{gauge.direction.tolist()}",
            )
        if covered[worst] < least[worst] - ROUNDING:
            raise scenario.where.error(
                ("gauge", name, "edges"),
                f"gauge.{name}.edges reach beyond the face: {100 * covered[worst]:.0f} % of panel "
                f"{worst} is wall; it may lack a spacing, {scenario.dp:g} m, along each edge, and "
                "half a panel at most",
            )


def _least_covered(gauge: Panels, dp: float) -> np.ndarray:
    """Share (panels,) of each panel that must be wall: at an end of an edge a spacing less."""
    least = np.ones(1)
    for size, count in zip(gauge.size, gauge.panels, strict=True):
        end = np.isin(np.arange(count), (0, count - 1))
        least = np.outer(np.where(end, 1 - MISSING * dp / size, 1.0), least).ravel()
    inside = 1 - MISSING * dp / gauge.size.min()  # the rows of a body that stands askew have gaps
    return np.maximum(np.where(least == 1.0, inside, least), LEAST)
