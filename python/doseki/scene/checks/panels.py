"""Checks of panels, which must lie on the walls that they are named on."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.gauges.gauge import State
from ...scenario.gauges.loads.panels import Panels
from ...scenario.model import Scenario

LEAST = 0.6  # share of a panel that is wall: edges of bodies do not meet whole particles


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
