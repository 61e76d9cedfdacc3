"""Whether the ground of a terrain holds what flows on it, and its map shows it."""

from __future__ import annotations

from ...record.reader import Run
from ..ground.leaving import LOST, lost_share, unseen_share
from .verdicts import Check, judged, unknown

THROUGH = (1e-12, 0.01)  # share of the mass
LEFT = (LOST, 0.1)
UNSEEN = "no snapshot has what left, which outflows may have taken: a shorter time_out would tell"


def ground_check(run: Run) -> list[Check]:
    """What went through the ground and beyond the map, over all the mass; nothing without a
    terrain.
    """
    said = run.summary
    if "terrain" not in run.scenario or "mass_through_ground" not in said:
        return []
    mass = said["mass_initial"] + said["mass_entered"]
    share = said["mass_through_ground"] / mass if mass else 0.0
    counted = "mass that went through the ground, where it was taken out, over that of the run"
    remedy = "raise speed_max, lower dp, or smooth the map: it has pits that particles do not fill"
    through = judged("ground", share, THROUGH, counted, remedy)
    if run.scenario.get("outflow") and unseen_share(said) >= LOST:
        return [through, unknown("left the map", LEFT, UNSEEN)]
    counted = "mass that went over the edge of the map and into cells without data, over that of"
    counted += " the run; what outflows take does not count"
    remedy = "take a larger map, fill its cells without data, or give an [outflow] where it may"
    remedy += " leave: run-out, maps and deposit are without it"
    return [through, judged("left the map", lost_share(said), LEFT, counted, remedy)]
