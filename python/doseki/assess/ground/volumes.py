"""What of releases and lakes is in a run: what other bodies take of them is not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...record.particles import FREE
from ...record.reader import Run
from ...record.units import unit_in
from ...scenario.model import Scenario
from ...scene.kinds.release import released_volumes
from ..lakes import filled_volumes

KEYS = ("body", "motion", "mass", "density")  # of a state
ROUNDING = 1e-4  # of a volume
Told = dict[str, tuple[float, float]]  # by body: as given, and in the run, m3 (2-D: m2)


@dataclass(frozen=True)
class Volumes:
    """Of what lies on a terrain when a run begins, m3 (2-D: m2)."""

    released: Told  # area times thickness, and what is in the run
    filled: Told  # boxes that the ground cuts: what is above it, and what is in the run
    taken: dict[str, float]  # that lies inside other bodies, where there is any

    @property
    def table(self) -> dict[str, Any]:
        """What summary.json has of them."""
        found = {"released": self.released, "filled": self.filled, "taken": self.taken}
        return {key: value for key, value in found.items() if value}


def volumes_at_start(
    scenario: Scenario, state: Mapping[str, np.ndarray], names: Sequence[str]
) -> Volumes:
    """From the particles that a run begins with; `state` has KEYS, with indices of `names`."""
    given = {"released": released_volumes(scenario), "filled": filled_volumes(scenario)}
    told: dict[str, Told] = {}
    taken: dict[str, float] = {}
    for kind, planned in given.items():
        told[kind] = {}
        for name, (asked, made) in planned.items():
            own = (state["body"] == names.index(name)) & (state["motion"] == FREE)
            gone = made - float((state["mass"][own] / state["density"][own]).sum())
            if gone > ROUNDING * made:
                taken[name] = gone
            if kind == "released" or asked != made or name in taken:
                told[kind][name] = asked, made - taken.get(name, 0.0)
    return Volumes(told["released"], told["filled"], taken)


def volumes_of(scenario: Scenario, run: Run) -> Volumes:
    """The same from the first snapshot of a run."""
    if scenario.bed is None:
        return Volumes({}, {}, {})
    first = run[0]
    return volumes_at_start(scenario, {key: first.stored(key) for key in KEYS}, first.body_names)


def volume_lines(table: Mapping[str, Any], dim: int) -> dict[str, str]:
    """One line about each body from such a table."""
    unit, taken = unit_in("m3", dim), table.get("taken", {})
    said = {
        "released": "{inside:.5g} {unit} released; area times thickness is {asked:.5g} {unit}",
        "filled": "{inside:.5g} {unit} in particles; above the ground it has {asked:.5g} {unit}",
    }
    found = {}
    for kind, words in said.items():
        for name, volumes in table.get(kind, {}).items():
            asked, inside = (float(number) for number in volumes)
            found[name] = words.format(inside=inside, asked=asked, unit=unit)
            if name in taken:
                found[name] += f", of which {taken[name]:.4g} {unit} lie inside other bodies"
    return found
