"""The summary fits on one screen and says what matters."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.summary import duration_text, summary_text
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from ..synthetic_runs import flow_state


def test_a_front_of_no_fluid_is_none(tmp_path, record_run):
    """All of it has left."""

    def draining(time):
        state = flow_state(time)
        stays = (state["material"] != 0) | (time < 2)
        return {name: values[stays] for name, values in state.items()}

    record_run(tmp_path / "run", state_at=draining)
    assert "front             no fluid is left at 2 s" in summary_text(load(tmp_path / "run"))


def test_summary_of_a_flow(flow_folder):
    text = summary_text(load(flow_folder))
    assert "synthetic" in text
    assert "3 s of 2 s" in text
    assert "1 min 15 s" in text
    assert "5 kg/m initial + 3 entered" in text
    assert "residual 0" in text
    assert "61 free, speed 1 m/s mean" in text
    assert "fluid from 2 s on, mean v_x -1 m/s" in text
    assert "front             x = 0 m" in text
    assert "warning           thin" in text
    assert len(text.splitlines()) <= 25


def test_a_run_without_a_step_has_no_length_of_steps(tmp_path, record_run, recwarn):
    """A full disk ended it: it has no summary."""
    record_run(tmp_path / "run", times=(0.0,), state_at=flow_state)
    assert "steps             0, the last one" in summary_text(load(tmp_path / "run"))
    assert not recwarn.list


SECTION = """
[gauge.down]
kind = "section"
left = [0.0, 1.0]
right = [0.0, 0.0]
interval = 1.0
"""


@pytest.mark.parametrize(
    ("width", "rate", "said"),
    [
        (0.0, 0.0, "nothing yet"),
        (0.0, 3.2, "peak 3.2 m3/s at 1 s, 3.2 m3 passed, nowhere as deep as half a particle (0.05"),
        (2.0, 3.2, "flow from 1 s on, peak 3.2 m3/s at 1 s, 3.2 m3 passed, depth up to 0.5 m"),
        (
            2.0,
            -3.2,
            "flow from 1 s on, peak -3.2 m3/s at 1 s, -3.2 m3 passed (against its direction: swap "
            "left and right), depth up to 0.5 m",
        ),
    ],
)
def test_what_passed_a_section(tmp_path, record_run, width, rate, said):
    """A film thinner than half of dp, which has discharge and no width, too."""
    recorder, _ = record_run(tmp_path / "run", dim=3, tables=SECTION)
    deep = 0.5 if width else np.nan
    for time, now in ((0.0, 0.0), (1.0, 1.0), (2.0, 0.0)):
        row = {"time": time, "discharge": now * rate, "mass_rate": 0.0, "area": 0.0}
        row |= {"width": now * width, "depth": deep if now else np.nan, "speed": deep}
        recorder.gauge("down", [f"{name} [1]" for name in row], [list(row.values())])
    recorder.close({"status": "done"})
    text = summary_text(load(tmp_path / "run"))
    (line,) = (each for each in text.splitlines() if each.startswith("section down"))
    assert line[18:].startswith(said)


@pytest.mark.parametrize(("dp", "said"), [("0.1", "100 mm"), ("1.0", "1 m"), ("4.0", "4 m")])
def test_large_spacings_are_in_metres(flow_folder, dp, said):
    scenario = flow_folder / "scenario.toml"
    scenario.write_text(scenario.read_text().replace("dp = 0.1", f"dp = {dp}"))
    assert f"dp = {said}," in summary_text(load(flow_folder))


def test_summary_without_snapshots_or_history(tmp_path, record_run):
    record_run(tmp_path / "run", times=())
    assert "synthetic" in summary_text(load(tmp_path / "run"))


def test_long_times_are_in_hours():
    assert duration_text(9.96) == "10.0 s"
    assert duration_text(75) == "1 min 15 s"
    assert duration_text(3599) == "59 min 59 s"
    assert duration_text(87884) == "24 h 25 min"


POOL = """
dim = 2
dp = 0.02
scheme = "resolved"
speed_max = 0.5
time_max = 0.02
time_out = 0.02
gravity = [0, -9.81]
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.1]
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [-0.06, -0.02]
max = [0.46, 0]
"""


@pytest.mark.parametrize("stopped", [False, True])
def test_what_is_doubtful_before_a_run_stands_in_its_summary(tmp_path, stopped):
    """Once each, also where the run was stopped on its way and resumed."""
    (tmp_path / "pool.toml").write_text(POOL)
    told, folder = [], tmp_path / "run"

    def stop(*_):
        if stopped:
            (folder / "STOP").touch()

    options = RunOptions(1, progress=stop, started=lambda *started: told.extend(started[-1]))
    run_scenario(load_scenario(tmp_path / "pool.toml"), folder, options)
    if stopped:
        assert load(folder).summary["status"] == "stopped"
        resume_run(folder, (), RunOptions(1))
    warnings = load(folder).summary["warnings"]
    for words in ("several per cent off", "a wall of 1 layer has one face", "for Mach 0.1 set"):
        assert sum(words in each for each in told) == 1
        assert sum(words in each for each in warnings) == 1
        assert words in (folder / "summary.txt").read_text()
