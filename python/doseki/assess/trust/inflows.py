"""Whether fluid went back past the section at which it enters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...errors import UserError
from ...record.particles import FREE
from ...record.reader import Run
from ...scenario.load import load_scenario
from ...scenario.model import Scenario
from ...scenario.values.directions import section_axes
from .verdicts import Check, judged, unknown

NAME = "flow back past an inflow"
BACK = (0.001, 0.02)  # share of the mass that has entered
BEHIND = 1.0  # spacings: the layers of an inflow swing by less
AROUND = 20.0  # spacings, or the height of the section: farther off it may have come another way

Mask = Callable[[np.ndarray], np.ndarray]  # of positions (n, dim), m


def inflows_check(run: Run) -> list[Check]:
    """Fluid beside and behind inflows that was in front of them; nothing without any.

    An inflow is as high as its layers: water that rises above them runs off over their backs.
    """
    if not run.scenario.get("inflow"):
        return []
    try:
        scenario = load_scenario(run.folder.scenario)
    except UserError:  # of a run whose files have gone, or of another version
        return [unknown(NAME, BACK, "the scenario of the run cannot be read")]
    back = _most_behind(run, scenario)
    entered = run.summary.get("mass_entered", 0.0)
    worst = sorted(filter(back.get, back), key=back.__getitem__, reverse=True)
    share = max(back.values(), default=0.0) / entered if entered else 0.0
    counted = f"mass behind an inflow that was in front of it, the most of {len(run)} snapshots,"
    counted += " over all that entered"
    remedy = (
        f"{', '.join(worst[:3])}: water stood higher than the layers, or ran back beside them; "
        "give the inflow a larger depth, or a wall behind it"
    )
    return [judged(NAME, share, BACK, counted, remedy)]


def _most_behind(run: Run, scenario: Scenario) -> dict[str, float]:
    """The most mass just behind each inflow in any snapshot, kg (2-D: kg/m)."""
    behind = {name: _behind(scenario, name) for name in scenario.inflow}
    before: dict[str, np.ndarray] = {}
    most = dict.fromkeys(behind, 0.0)
    for snapshot in run:
        free = snapshot["motion"] == FREE
        position, number, mass = (snapshot[key][free] for key in ("position", "id", "mass"))
        body = np.asarray(snapshot["body"])[free]
        for name, is_behind in behind.items():
            there = is_behind(position)
            if name not in before:  # what begins there may be a lake, or of another inflow
                before[name] = number[~there]
                continue
            own = (body == name) | np.isin(number, before[name])
            most[name] = max(most[name], float(mass[there & own].sum()))
    return most


def _behind(scenario: Scenario, name: str) -> Mask:
    """Tells which positions are behind a section, not far from it."""
    inflow, dp = scenario.inflow[name], scenario.dp
    up, across = section_axes(inflow.along, scenario.gravity)
    reach = max(AROUND * dp, inflow.height)

    def mask(position: np.ndarray) -> np.ndarray:
        apart = position - np.asarray(inflow.position)
        along, height = apart @ inflow.along, apart @ up
        found = (along < -BEHIND * dp) & (along > -reach)
        found &= (height > -reach) & (height < inflow.height + reach)
        if across is not None:
            beside = apart @ across
            found &= (beside > -reach) & (beside < inflow.width + reach)
        return np.asarray(found)

    return mask
