"""How far a flow has come on a map does not depend on which way it goes."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.summary import summary_text
from doseki.measure.advance import goes_along_x
from doseki.measure.flow import measure_flow
from doseki.record.reader import load
from doseki.report.parts.captions import of_figures

ALONG_X = "[-1.0, 0.0, -9.0]"
TURNS = (0.0, 35.0, 90.0, 200.0)
INFLOW = """
[inflow.spring]
position = [1.0, 2.0, 0.0]
direction = [0.0, 1.0, 0.0]
depth = 0.5
width = 0.5
rate = 0.5
material = "water"
"""


@pytest.fixture
def turned(tmp_path, record_run, plain_state):
    """A function: 200 particles of water that go at 2 m/s in a direction, a lake, and a drop."""

    def record(angle, gravity=ALONG_X, tables=""):
        way = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
        flow = np.random.default_rng(3).uniform(0, 1, (200, 3))
        lake = flow + np.array([50.0, 50.0, 0.0])

        def state_at(time):
            drop = np.array([[0.5, 0.5, 0.5]]) + 40 * time * way
            position = np.concatenate([flow + 2 * time * way, lake, drop])
            return plain_state(position, np.zeros_like(position), np.zeros(401, int))

        folder = tmp_path / f"run-{angle:g}"
        recorder, _ = record_run(folder, dim=3, state_at=state_at, tables=tables)
        recorder.close({"status": "done"})
        text = (folder / "scenario.toml").read_text().replace(ALONG_X, gravity)
        (folder / "scenario.toml").write_text(text)
        return load(folder)

    return record


@pytest.mark.parametrize("angle", TURNS)
def test_the_front_is_as_far_whichever_way_it_goes(turned, angle):
    """The drop, which is less than 1 % of what moves, decides nothing, nor does the lake."""
    run = turned(angle, gravity="[0.0, -1.0, -9.0]")
    flow = measure_flow(run)
    assert not flow.along_x
    assert flow.front == pytest.approx([0.0, 2.0, 4.0], abs=1e-5)
    assert "front             4 m from where it began at 2 s" in summary_text(run)
    assert of_figures(run)["flow"].startswith("How far the front has come")


def test_where_gravity_points_along_x_it_is_a_place(turned):
    """The control."""
    run = turned(0.0)
    flow = measure_flow(run)
    assert flow.along_x
    assert flow.front == pytest.approx([0.0, 2.0, 4.0], abs=0.05)
    assert "front             x = " in summary_text(run)
    assert of_figures(run)["flow"].startswith("The front of the flow")


@pytest.mark.parametrize(
    ("gravity", "tables", "along"),
    [
        (ALONG_X, "", True),
        ("[0.0, 0.0, -9.0]", "", True),
        ("[0.0, -1.0, -9.0]", "", False),
        ("[0.0, 0.0, -9.0]", INFLOW, False),
        ("[0.0, 0.0, -9.0]", INFLOW.replace("[0.0, 1.0, 0.0]", "[1.0, 0.0, 0.0]"), True),
    ],
)
def test_which_runs_go_along_x(turned, gravity, tables, along):
    assert goes_along_x(turned(0.0, gravity, tables)) == along


def test_what_enters_counts_from_its_section(tmp_path, record_run, plain_state):
    """Also what is 3 m down when it is seen first."""

    def state_at(time):
        position = np.array([[9.0, 9.0, 0.0], [1.0, 2.0 + 3 * time, 0.0]])[: 1 + (time > 0)]
        state = plain_state(position, np.zeros_like(position), np.zeros(len(position), int))
        return state | {"body": np.array([0, 1], np.int32)[: len(position)]}

    recorder, _ = record_run(
        tmp_path / "run", dim=3, state_at=state_at, tables=INFLOW.replace("spring", "grain")
    )
    recorder.close({"status": "done"})
    assert measure_flow(load(tmp_path / "run")).front == pytest.approx([0.0, 3.0, 6.0], abs=1e-5)


def test_what_has_left_does_not_take_the_front_back(tmp_path, record_run, plain_state):
    def state_at(time):
        position = np.array([[0.0, 5 * time, 0.0], [0.0, time, 0.0]])[int(time > 1) :]
        state = plain_state(position, np.zeros_like(position), np.zeros(len(position), int))
        return state | {"id": np.arange(2)[int(time > 1) :]}

    recorder, _ = record_run(tmp_path / "run", dim=3, state_at=state_at)
    recorder.close({"status": "done"})
    scenario = tmp_path / "run/scenario.toml"
    scenario.write_text(scenario.read_text().replace(ALONG_X, "[0.0, 1.0, -9.0]"))
    assert measure_flow(load(tmp_path / "run")).front == pytest.approx([0.0, 5.0, 5.0], abs=1e-5)
