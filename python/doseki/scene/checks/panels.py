"""Checks of panels, which must lie on the walls that they are named on."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.gauges.gauge import State
from ...scenario.gauges.loads.panels import Panels
from ...scenario.model import Scenario

LEAST = 0.5  # share of a panel that is wall, however small the panel
MISSING = 1.0  # spacings along an edge that need not be wall: bodies consist of whole particles
INNER = 3  # panels along an edge of which some are not at its ends
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
        if covered.max() < LEAST:
            raise scenario.where.error(
                ("gauge", name, "origin"),
                f"gauge.{name}.origin = {gauge.origin.tolist()}: no surface of "
                f"{', '.join(gauge.bodies)} lies in the plane of the panels and faces "
                f"{gauge.direction.tolist()}",
            )
        bare = _bare_panel(gauge, covered, scenario.dp)
        if bare is not None:
            raise scenario.where.error(
                ("gauge", name, "edges"),
                f"gauge.{name}.edges reach beyond the face: {100 * covered[bare]:.0f} % of panel "
                f"{bare} is wall; it may lack a spacing, {scenario.dp:g} m, along each edge, and "
                "half a panel at most",
            )


def _bare_panel(gauge: Panels, covered: np.ndarray, dp: float) -> int | None:
    """The panel that lacks more wall than it may, or one at an end of an edge where all do."""
    least = _least_covered(gauge, dp)
    worst = int(np.argmin(covered - least))
    if covered[worst] < least[worst] - ROUNDING:
        return worst
    ends = (_bare_end(gauge, covered, dp, edge) for edge in range(len(gauge.panels)))
    return next((panel for panel in ends if panel is not None), None)


def _least_covered(gauge: Panels, dp: float) -> np.ndarray:
    """Share (panels,) of each panel that must be wall.

    A row of particles that is not there, as on a slant, may lie along the longer side of any
    panel.  At an end of an edge a spacing less; along an edge of one panel that is all it may lack.
    """
    least = np.ones(1)
    for share, count in zip(_shares(gauge, dp), gauge.panels, strict=True):
        end = np.isin(np.arange(count), (0, count - 1))
        least = np.outer(np.where(end, share, 1.0), least).ravel()
    return np.maximum(np.minimum(least, _shares(gauge, dp).min()), LEAST)


def _shares(gauge: Panels, dp: float) -> np.ndarray:
    """Share (dim - 1,) of a panel that is left without a spacing along each edge."""
    return np.asarray(1 - MISSING * dp / gauge.size)


def _bare_end(gauge: Panels, covered: np.ndarray, dp: float, edge: int) -> int | None:
    """The panel with most wall at an end of an edge where each lacks more than a spacing along it.

    A row of particles that is not there takes wall from some of them, and from those inside.
    """
    count = gauge.panels[edge]
    number = np.arange(len(covered)).reshape(gauge.panels[::-1])
    number = np.moveaxis(number, -1 - edge, 0).reshape(count, -1)
    inside = min(1.0, covered[number[1:-1]].max()) if count >= INNER else 1.0
    at_ends = [k == edge or other < INNER for k, other in enumerate(gauge.panels)]
    least = max(float(np.prod(_shares(gauge, dp)[at_ends])) * inside, LEAST)
    for panels in number[[0, -1]]:
        best = int(panels[covered[panels].argmax()])
        if covered[best] < least - ROUNDING:
            return best
    return None
