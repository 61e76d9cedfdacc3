"""Windows over time on a run whose flow is known by construction (synthetic_runs.flow_state)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.measure import views
from doseki.measure.flow import measure_flow
from doseki.record.reader import load


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
