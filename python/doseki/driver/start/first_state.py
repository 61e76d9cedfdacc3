"""The state with which a run begins: its scene, or all that an earlier run knew at that time."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...errors import UserError
from ...scenario.earlier import Earlier
from ...scenario.model import Scenario
from ...scenario.tables.wall import FRICTION_OF
from ...scene.build import body_names
from ...solver.build import empty_simulation
from ...solver.protocol import Simulation
from ...solver.restoring import with_new_meters
from ...util.finding import Finding
from ...util.foreign import read_bytes
from ...util.telling import Tell, say_nothing
from ..checkpoint import Checkpoint, DamagedCheckpointError, from_bytes
from ..ranks import OneRank

# Keys of a body that are no part of its state: how fluid meets it, and what it does from now on.
NOT_OF_STATE = {"wall", *FRICTION_OF, "motion", "file"}
# What the state of elastic bodies holds in numbers.
OF_STATE = ("young_modulus", "poisson_ratio")
# With which no rate of change changes, and no list of neighbours.
OF_RECORD = {
    "time_max", "time_out", "time_history", "title", "description", "gauge", "window", "figure",
    "maps", "start", "parameters", "cflnumber", "cfl_force",
}  # fmt: skip


class FirstState(NamedTuple):
    """A simulation, the names of its bodies and warnings."""

    simulation: Simulation
    body_names: list[str]
    warnings: Sequence[Finding]
    goes_on: bool  # with the rates of change and lists that it has: it is not to be started


@dataclass(frozen=True)
class UnusedCheckpoint(Finding):
    """A checkpoint of the earlier run that cannot be used."""

    why: str

    def __str__(self) -> str:
        return f"{self.place}: the checkpoint cannot be used ({self.why}), only the snapshot"


def first_state(scenario: Scenario, ranks: OneRank, tell: Tell = say_nothing) -> FirstState:
    """The state with which a run begins; raises UserError where the scenario allows none.

    Where the earlier run of the scenario has a checkpoint at that time and the bodies are the same,
    everything goes on as it was; else bodies are made, or taken from its snapshot.
    """
    doubts = list[Finding]()
    if (earlier := with_checkpoint(scenario)) is not None:
        own = tomllib.loads(scenario.effective_toml())
        try:
            return _gone_on(scenario, earlier, _changed(own, earlier) <= OF_RECORD, ranks)
        except (DamagedCheckpointError, UserError, ValueError) as error:
            doubts.append(UnusedCheckpoint("start", str(error)))
    simulation, names, warnings = ranks.filled_simulation(scenario, tell)
    return FirstState(simulation, names, [*warnings, *doubts], False)


def with_checkpoint(scenario: Scenario) -> Earlier | None:
    """The earlier run, if all of its bodies are to go on from a checkpoint that it has."""
    earlier = scenario.earlier
    if earlier is None or earlier.checkpoint is None:
        return None
    return earlier if _has_same_bodies(tomllib.loads(scenario.effective_toml()), earlier) else None


def _gone_on(scenario: Scenario, earlier: Earlier, is_same: bool, ranks: OneRank) -> FirstState:
    assert earlier.checkpoint is not None
    checkpoint = from_bytes(read_bytes(earlier.checkpoint), earlier.checkpoint)
    _check(scenario, earlier, checkpoint)
    state = checkpoint.state
    if not is_same:
        # As of several ranks: without lists, which may be others with other parameters.
        state = state | {"lanes": state["lanes"] * 0}
    state = with_new_meters(empty_simulation(scenario, checkpoint.body_names), state)
    simulation, _ = ranks.restored_simulation(scenario, checkpoint.body_names, state)
    return FirstState(simulation, checkpoint.body_names, earlier.findings, True)


def _check(scenario: Scenario, earlier: Earlier, checkpoint: Checkpoint) -> None:
    """Raise UserError for a checkpoint of another moment, or of other bodies."""
    then = checkpoint.material_names, checkpoint.body_names
    if checkpoint.time != earlier.time or checkpoint.step != earlier.snapshot.step:
        raise UserError("it is not of the time of the snapshot")
    if then != (scenario.material_names, body_names(scenario)):
        raise UserError("its materials or bodies are not those of the scenario")


def _has_same_bodies(own: Mapping[str, Any], earlier: Earlier) -> bool:
    """Whether bodies, inflows and terrain are those of the earlier run, in the same order."""
    beds = own.get("terrain"), earlier.scenario.get("terrain")
    if _without(beds[0], {"file"}) != _without(beds[1], {"file"}):  # the digest tells
        return False
    for section, free in (("body", NOT_OF_STATE), ("inflow", set[str]())):
        now, then = own.get(section, {}), earlier.section(section)
        if list(now) != list(then):
            return False
        if any(_without(now[name], free) != _without(then[name], free) for name in now):
            return False
    materials = own["material"], earlier.section("material")
    return all(
        materials[0][name].get(key) == materials[1].get(name, {}).get(key)
        for name in materials[0]
        for key in OF_STATE
    )


def _without(table: Any, keys: set[str]) -> Any:
    if not isinstance(table, dict):
        return table
    return {key: value for key, value in table.items() if key not in keys}


def _changed(own: Mapping[str, Any], earlier: Earlier) -> set[str]:
    """The top-level keys and sections in which the scenarios differ."""
    return {
        key
        for key in {*own, *earlier.scenario}
        if key not in ("body", "inflow") and own.get(key) != earlier.scenario.get(key)
    }
