"""Goes on from checkpoints that somebody has changed, in a process of its own: a crash is its end.

    python -m tests.fuzz.checkpoint_mutations COUNT LOG

Prints how many were refused, failed in their physics, and went on; LOG holds the last one tried.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from tests.fuzz.generators import EVERYTHING
from tests.run.channel import channel_text
from tests.terrain.scenes import grid
from tests.terrain.scenes import text as terrain_text

from doseki.scenario.load import load_scenario
from doseki.scenario.model import Scenario
from doseki.solver.build import build_simulation, empty_simulation, load_core
from doseki.solver.protocol import Columns
from doseki.solver.restoring import check_state

STEPS = 3
JUNK = [
    float("nan"), float("inf"), -float("inf"), 0.0, -1.0, 1.0, 0.5, 1e-300, 1e300, -1e300, 32767.0,
    -32768.0, 2.0**31 - 1, -(2.0**31), 2.0**63, 255.0, 2.0**27, 2.0**32 - 1,
]  # fmt: skip
SLIDE = """
[body.slide]
shape = "release"
material = "water"
polygon = [[0.5, 1], [1.5, 1], [1.5, 2], [0.5, 2]]
thickness = 0.3
"""
OPERATIONS = (
    "cut", "empty", "double", "drop", "retype", "reshape", "set", "set", "set", "fill", "shuffle",
    "noise", "exchange", "neutral",
)  # fmt: skip


class Start:
    """A state to go on from, and what comes of it."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        simulation, self.names = build_simulation(scenario)
        simulation.advance(limit=1.0, pause=1.0, max_steps=30)
        self.state = {name: values.copy() for name, values in simulation.checkpoint().items()}
        self.after = self.gone_on(self.state)

    def gone_on(self, state: Columns) -> Columns:
        """The particles some steps after `state`."""
        simulation = empty_simulation(self.scenario, self.names)
        check_state(simulation, state, len(self.scenario.material_names), len(self.names))
        simulation.restore(state)
        simulation.advance(limit=1.0, pause=1.0, max_steps=STEPS)
        simulation.grains(), simulation.totals(), simulation.rates()
        return simulation.state()


def _cast(values: np.ndarray, junk: float) -> Any:
    """The junk as the array can hold it."""
    if values.dtype.kind == "f":
        return junk
    limits = np.iinfo(values.dtype)
    whole = int(junk) if math.isfinite(junk) else 0
    return min(max(whole, int(limits.min)), int(limits.max))


def changed(state: Columns, draw: Any) -> tuple[Columns, str]:
    """The state with one array changed, and in which way."""
    state = dict(state)
    name = draw(st.sampled_from(sorted(state)))
    how = draw(st.sampled_from(OPERATIONS))
    values = state[name].copy()
    flat = values.reshape(-1)
    place = draw(st.integers(0, max(0, flat.size - 1)))
    junk = draw(st.sampled_from(JUNK))
    random = np.random.default_rng(place)
    if how == "cut":
        values = values[: len(values) - 1 - place % 3]
    elif how == "empty":
        values = values[:0]
    elif how == "double":
        values = np.concatenate([values, values])
    elif how == "retype":
        values = values.astype(np.float32 if values.dtype.kind == "f" else np.int8)
    elif how == "reshape":
        values = values.reshape(-1, 1) if values.ndim == 1 else flat
    elif how == "set" and flat.size:
        flat[place] = _cast(values, junk)
    elif how == "fill":
        flat[:] = _cast(values, junk)
    elif how == "shuffle":
        random.shuffle(values)
    elif how == "noise":
        values = np.frombuffer(random.bytes(values.nbytes), values.dtype).reshape(values.shape)
    elif how == "exchange":
        values = state[draw(st.sampled_from(sorted(state)))].copy()
    state[name] = np.ascontiguousarray(values)
    if how == "drop":
        del state[name]
    return state, f"{how} {name} {place} {junk}"


@dataclass(repr=False)
class Case:
    """A start, its state changed, and in which way."""

    start: Start
    state: Columns
    told: str

    def __repr__(self) -> str:
        return self.told


@st.composite
def mutations(draw: st.DrawFn, starts: list[Start]) -> Case:
    """A start, its state with one to three arrays changed, and what was done."""
    start = draw(st.sampled_from(starts))
    state, told = start.state, start.scenario.scheme
    for _ in range(draw(st.integers(1, 3))):
        state, how = changed(state, draw)
        told += f"; {how}"
        if not state:
            break
    return Case(start, state, told)


def unchanged(one: Columns, other: Columns) -> bool:
    """Whether two states hold the same bytes in the same form."""
    return one.keys() == other.keys() and all(
        (values.dtype, values.shape) == (other[name].dtype, other[name].shape)
        and values.tobytes() == other[name].tobytes()
        for name, values in one.items()
    )


def same(one: Columns, other: Columns) -> bool:
    """Whether two states agree to the bit."""
    return all(np.array_equal(one[name], other[name]) for name in other)


def main(count: int, log: Path) -> None:
    """Try `count` mutations."""
    load_core().set_threads(1)
    failure = load_core().PhysicsFailure
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "case.toml"
        starts = []
        grid(Path(folder) / "terrain.asc", lambda x, y: 2 - 0.5 * x + 0.1 * np.sin(3 * y), (4, 3))
        for text in (channel_text(), EVERYTHING, terrain_text(3, more=SLIDE)):
            file.write_text(text)
            starts.append(Start(load_scenario(file)))
    counts: Counter[str] = Counter()

    @settings(max_examples=count, deadline=None, database=None, phases=[Phase.generate],
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(mutations(starts))
    def try_one(case: Case) -> None:
        start, state, told = case.start, case.state, case.told
        log.write_text(told)
        whole = unchanged(start.state, state)
        try:
            after = start.gone_on(state)
        except ValueError:
            assert not whole, told
            counts["refused"] += 1
        except failure:
            counts["failed"] += 1
        else:
            counts["went on"] += 1
            assert not whole or same(after, start.after), told

    try_one()
    print(json.dumps(counts))


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
