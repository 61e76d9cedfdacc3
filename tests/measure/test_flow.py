"""Windows over time on a run whose flow is known by construction (synthetic_runs.flow_state)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.assess.summary import summary_text
from doseki.errors import UserError
from doseki.measure import views
from doseki.measure.flow import measure_flow
from doseki.record.fields import GRAIN_FIELDS
from doseki.record.particles import BOUND
from doseki.record.reader import load
from doseki.record.writer import Recorder

from ..synthetic_runs import BODIES, FLOW_TABLES, MATERIALS, SCENARIO

BODIES_SCENARIO = SCENARIO.format(dim=2, zeros="") + FLOW_TABLES


def test_front_moves_down_the_slope_at_one_metre_a_second(flow_folder):
    flow = measure_flow(load(flow_folder))
    assert np.allclose(flow.front, 3.0 - flow.times)


def test_window_shows_fluid_when_it_arrives(flow_folder):
    flow = measure_flow(load(flow_folder))
    end = flow.windows["end"]
    assert end.arrival(flow.times) == 2.0
    assert math.isnan(end.fluid_velocity[0])
    assert end.fluid_velocity[-1] == pytest.approx(-1.0)


def test_window_weighs_the_grains_and_counts_those_that_passed(flow_folder):
    end = measure_flow(load(flow_folder)).windows["end"]
    assert end.grain_count[0] == 3
    assert end.grain_mass[0] == 3.0
    assert end.grain_speed[0] == pytest.approx(0.5)
    assert end.grain_count[-1] == 0
    assert end.passed_mass[0] == 0.0
    assert end.passed_mass[-1] == 3.0


@pytest.fixture
def bodies_run(tmp_path, plain_state):
    """A run of two bodies of six particles and 7 kg each, at 1 m/s; the second crosses x = 0."""
    recorder = Recorder(tmp_path / "bodies", BODIES_SCENARIO, MATERIALS, BODIES, 2)
    for time in (0.0, 1.0):
        centre = np.array([[0.75, 0.1], [0.25 - 0.5 * time, 0.1]])
        points = (centre[:, None, :] + 0.01 * np.arange(6)[:, None]).reshape(-1, 2)
        position = np.concatenate([points, [[0.5, 0.1]]])
        state = plain_state(position, np.zeros_like(position), np.r_[np.ones(12, int), 0])
        state["motion"][:12] = BOUND
        state["grain"][:12] = np.repeat([0, 1], 6)
        table = {
            field.key: np.zeros({"vector": (2, 2), "rows": (2, 3), "scalar": 2}[field.shape])
            for field in GRAIN_FIELDS
        }
        table |= {"position": centre, "velocity": np.array([[0.6, 0.8]] * 2)}
        table |= {"mass": np.full(2, 7.0), "diameter": np.full(2, 0.06)}
        table["orientation"] = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))
        recorder.snapshot(state, time=time, step=1, dt=0.1, grains=table)
    return load(recorder.directory)


def test_windows_count_bodies_and_not_their_particles(bodies_run):
    end = measure_flow(bodies_run).windows["end"]
    assert end.grain_count == [2, 1]
    assert end.grain_mass == [14.0, 7.0]
    assert end.grain_speed == pytest.approx([1.0, 1.0])
    assert end.passed_mass == [0.0, 7.0]
    assert end.fluid_count == [1, 1]


def test_the_summary_says_how_many_grains_there_are(bodies_run):
    lines = [line for line in summary_text(bodies_run).splitlines() if "window end" in line]
    assert "; 2 grains, mean speed 1 m/s" in lines[0]


INFLOW = """
[inflow.{name}]
material = "water"
rate = {rate}
width = 1
position = [0, 0]
direction = {direction}
depth = 0.1
duration = 1
"""


@pytest.mark.parametrize(
    ("gravity", "inflows", "expected"),
    [
        ("[-1.0, -9.0]", [(1, "[1, 0]")], -1),
        ("[0.0, -9.8]", [(1, "[-1, 0]")], -1),
        ("[1e-16, -9.8]", [(1, "[-1, 0]")], -1),  # as sin(pi) makes it
        ("[0.0, -9.8]", [(1, "[-2, 0]"), (3, "[0.5, 0.5]")], 1),
        ("[0.0, -9.8]", [(1, "[-2, 0]"), (1, "[1, 0]")], 0),
        ("[0.0, -9.8]", [], 0),
        ("[0.0, 0.0]", [], 0),
    ],
)
def test_the_flow_runs_as_gravity_or_else_the_inflows_say(
    tmp_path, record_run, gravity, inflows, expected
):
    tables = "".join(
        INFLOW.format(name=f"i{k}", rate=rate, direction=direction)
        for k, (rate, direction) in enumerate(inflows)
    )
    record_run(tmp_path / "run", tables=tables)
    text = tmp_path / "run" / "scenario.toml"
    text.write_text(text.read_text().replace("[-1.0, -9.0]", gravity))
    assert views.flow_direction(load(tmp_path / "run")) == expected


def test_a_run_without_fluid_has_no_flow(two_grains):
    assert measure_flow(load(two_grains)) is None


def test_snapshots_before_and_with_the_flow(flow_folder):
    run = load(flow_folder)
    view = views.named_window(run, "end")
    assert run[views.before_flow(run, view)].time == 1.75
    assert run[views.with_flow(run, view)].time == 3.0


def test_spray_along_the_window_is_not_the_flow(tmp_path, record_run, plain_state):
    """Drops fly through all of a window of one metre until 60 and then 30 of them run there."""

    def state_at(time):
        drops = {0.0: 0, 1.0: 12, 2.0: 60, 3.0: 30}[time]
        x = np.r_[np.linspace(0.01, 0.99, drops), -1.0]
        position = np.stack([x, np.full(len(x), 0.05)], axis=1)
        return plain_state(position, np.zeros_like(position), np.r_[np.zeros(drops, int), 2])

    record_run(tmp_path / "run", times=(0.0, 1.0, 2.0, 3.0), state_at=state_at)
    run, view = load(tmp_path / "run"), views.View(np.zeros(2), np.ones(2))
    assert run[views.with_flow(run, view)].time == 2.0
    assert run[views.before_flow(run, view)].time == 0.0


def test_fixed_particles_are_not_selected(flow_folder):
    run = load(flow_folder)
    everywhere = views.whole_space(2)
    assert not np.any(run[0]["fixed"][views.select(run[0], everywhere)])


def test_tilt_puts_gravity_upright(flow_folder):
    run = load(flow_folder)
    gravity = np.array([run.scenario["gravity"]])
    turned = views.whole_space(2, rotate=-views.tilt(run)).coordinates(gravity)
    assert np.allclose(turned, [[0.0, -math.hypot(1.0, 9.0)]])


def test_an_unknown_window_is_met_with_the_nearest_known_one(flow_folder):
    with pytest.raises(UserError, match="did you mean end"):
        views.named_window(load(flow_folder), "ende")


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("law = 'gas'", "material.water.law = 'gas' is not allowed"),
        ("rheology = 1e300", "material.water.rheology = 1e+300 is not allowed"),
        ("fracture = 'cohesive'", "material.water: fracture"),
    ],
)
def test_a_material_that_cannot_be_is_refused(flow_folder, value, said):
    file = flow_folder / "scenario.toml"
    file.write_text(f"{file.read_text()}\n[material.water]\n{value}\n")
    with pytest.raises(UserError) as caught:
        measure_flow(load(flow_folder))
    assert str(file) in str(caught.value)
    assert said in str(caught.value)
