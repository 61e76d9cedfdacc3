"""What tests of several packages share: small scenario files, and small recorded runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadScopeScheduling

from doseki.errors import UserError
from doseki.record.writer import Recorder
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies
from doseki.scene.inflow_sections import build_inflows

from .small_scenarios import BLOCK, MINIMAL
from .synthetic_runs import (
    BODIES,
    FLOW_TABLES,
    MATERIALS,
    SCENARIO,
    State,
    flow_state,
    history_row,
    make_plain_state,
    random_state,
)

RecordRun = Callable[..., tuple[Recorder, list[State]]]


# The same random inputs in every session, and other ones in each. How long an input takes is no
# matter: it depends on what else the machine does.
settings.register_profile(
    "fixed",
    derandomize=True,
    deadline=None,
    database=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile("free", settings.get_profile("fixed"), derandomize=False)
settings.load_profile("fixed")


class RanksTogether(LoadScopeScheduling):
    """Gives all tests that start ranks to one worker, each of the others to whichever is free.

    Ranks spin while they wait for each other: two such tests at once take many times as long.
    """

    def _split_scope(self, nodeid: str) -> str:
        return "ranks" if nodeid.startswith("tests/parallel/") else nodeid


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(
    config: pytest.Config, log: Callable[..., None]
) -> RanksTogether | None:
    """With `--dist loadgroup`. Marks of groups, which this is for, go unheeded in pytest 9."""
    return RanksTogether(config, log) if config.getvalue("dist") == "loadgroup" else None


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., str]:
    """Write a scenario: top-level lines, then tables (a block of water by default)."""

    def write_file(top: str = "", tables: str = BLOCK, name: str = "case.toml") -> str:
        path = tmp_path / name
        path.write_text(f"{MINIMAL}{top}\n{tables}", encoding="utf-8")
        return str(path)

    return write_file


def load_and_build(path: str, overrides: Sequence[str]) -> None:
    """All that is done with a scenario before a run."""
    scenario = load_scenario(path, overrides)
    particles, names = build_bodies(scenario)
    build_inflows(scenario, names, particles)


@pytest.fixture
def error_of() -> Callable[..., str]:
    """The message of the UserError that loading and building a scenario raises."""

    def message(path: str, *overrides: str) -> str:
        with pytest.raises(UserError) as caught:
            load_and_build(path, overrides)
        text = str(caught.value)
        assert "\n" not in text
        return text

    return message


@pytest.fixture
def record_run() -> RecordRun:
    """A function that records given states at given times; the recorder is still open."""

    def record(
        directory: Path,
        dim: int = 2,
        times: tuple[float, ...] = (0.0, 1.0, 2.0),
        state_at: Callable[[float], State] | None = None,
        tables: str = "",
    ) -> tuple[Recorder, list[State]]:
        text = SCENARIO.format(dim=dim, zeros="0.0, " * (dim - 2)) + tables
        recorder = Recorder(directory, text, MATERIALS, BODIES, dim)
        states = []
        for time in times:
            seed = int(100 * time)
            states.append(state_at(time) if state_at else random_state(20, dim, seed))
            recorder.snapshot(states[-1], time=time, step=int(10 * time), dt=0.1)
            recorder.history(history_row(time))
        return recorder, states

    return record


@pytest.fixture
def plain_state() -> Callable[..., State]:
    """The function make_plain_state."""
    return make_plain_state


@pytest.fixture
def run_folder(tmp_path: Path, record_run: RecordRun) -> Path:
    """The folder of a finished 2-D run of three random snapshots at 0, 1 and 2 s."""
    recorder, _ = record_run(tmp_path / "run")
    recorder.close({"status": "done"})
    return tmp_path / "run"


@pytest.fixture
def flow_folder(tmp_path: Path, record_run: RecordRun) -> Path:
    """The folder of a finished run of flow_state, 0 to 3 s, with a window and figures."""
    times = tuple(np.arange(0.0, 3.01, 0.25))
    recorder, _ = record_run(
        tmp_path / "flow", times=times, state_at=flow_state, tables=FLOW_TABLES
    )
    recorder.close(
        {"status": "done", "wall_seconds": 75.0, "bytes_per_particle": 400.0, "warnings": ["thin"]}
        | history_row(3.0)
    )
    return tmp_path / "flow"


@pytest.fixture
def two_grains(tmp_path: Path, record_run: RecordRun) -> Path:
    """The folder of a run of two grains that approach, without fluid."""

    def state(time: float) -> State:
        position = np.array([[-1.0, 0.0], [1.0 - 0.5 * time, 0.0]])
        velocity = np.array([[0.0, 0.0], [-0.5, 0.0]])
        return make_plain_state(position, velocity, np.array([1, 1]))

    tables = '\n[figure.pair]\nkind = "snapshot"\ntimes = [0.0, 2.0]\ncolour = ["velocity_x"]\n'
    recorder, _ = record_run(tmp_path / "pair", state_at=state, tables=tables)
    recorder.close({})
    return tmp_path / "pair"
