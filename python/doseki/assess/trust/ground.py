"""Whether the ground of a terrain holds what flows on it."""

from __future__ import annotations

from ...record.reader import Run
from .verdicts import Check, judged

THROUGH = (1e-12, 0.01)  # share of the mass


def ground_check(run: Run) -> list[Check]:
    """What went through the ground, over all the mass; nothing without a terrain."""
    said = run.summary
    if "terrain" not in run.scenario or "mass_through_ground" not in said:
        return []
    mass = said["mass_initial"] + said["mass_entered"]
    share = said["mass_through_ground"] / mass if mass else 0.0
    counted = "mass that went through the ground, where it was taken out, over that of the run"
    remedy = "raise speed_max, lower dp, or smooth the map: it has pits that particles do not fill"
    return [judged("ground", share, THROUGH, counted, remedy)]
