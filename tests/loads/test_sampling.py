"""What samples of a load cost: walls that stand still are looked at once; `check` counts them."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess import sampling
from doseki.assess.cost import estimate
from doseki.driver.gauges import build_gauges
from doseki.driver.meters import LoadMeans
from doseki.record.particles import FIXED
from doseki.scenario.gauges.loads import standing_water
from doseki.scenario.gauges.loads.overtopping import LOOKS
from doseki.scenario.gauges.loads.standing_water import Known
from doseki.solver.build import build_simulation

from .scenes import STREAM, scenario_of

POOL = """\
dim = 2
dp = 0.02
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 3
gravity = [0, -9.81]
[body.tank]
shape = "tank"
material = "aluminium"
min = [0, 0]
max = [0.8, 0.8]
[body.stone]
material = "basalt"
fixed = true
shape = "box"
min = [0.4, 0]
max = [0.5, 0.4]
normal = [1, 0]
[body.block]
material = "basalt"
fixed = true
shape = "box"
normal = [0, 1]
min = [0.5, 0]
max = [0.8, 0.3]
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.8, 0.6]
[gauge.stone]
kind = "load"
bodies = ["stone"]
interval = 0.01
"""


class Without:
    """A run without the particles of one body."""

    def __init__(self, run, body):
        self.run, self.body, self.time = run, body, 0.0

    def sample(self, low, high):
        state = self.run.sample(list(low), list(high))
        return {key: values[state["body"] != self.body] for key, values in state.items()}


@pytest.fixture
def pool(tmp_path):
    simulation, names = build_simulation(scenario_of(tmp_path, POOL))
    (reader,) = build_gauges(scenario_of(tmp_path, POOL), names)
    return simulation, names, reader


def test_what_walls_decide_is_worked_out_once(pool, monkeypatch):
    """And anew, to the same bits, where a wall has come."""
    simulation, names, reader = pool
    looks, surface_of = [], standing_water.surface_of
    monkeypatch.setattr(
        standing_water, "surface_of", lambda *given: looks.append(1) or surface_of(*given)
    )
    far, known = np.full(2, np.inf), Known()

    def static(run, known=None):
        return reader.gauge.static(run, reader.setting, (-far, far), known)

    before = Without(simulation, names.index("block"))
    bare, covered = static(before), static(simulation)
    looks.clear()
    for run, expected, high in ((before, bare, 0.4), (simulation, covered, 0.1)):
        for _ in range(3):
            np.testing.assert_array_equal(static(run, known), expected)
        area = np.linalg.norm(known.outside.elements.area, axis=1).sum()
        assert area == pytest.approx(high, abs=0.02)
    assert len(looks) == 2
    static(simulation)
    static(simulation)
    assert len(looks) == 4


def test_a_gauge_of_a_body_that_stands_still_looks_at_it_once(pool, monkeypatch):
    simulation, _, reader = pool
    learnt, learn = [], Known.learn
    monkeypatch.setattr(Known, "learn", lambda *given: learnt.append(1) or learn(*given))
    means = LoadMeans(reader)
    simulation.start()
    for _ in range(4):
        simulation.advance(limit=1, pause=1, max_steps=1)
        means.sample(simulation)
    assert len(learnt) == 1


@pytest.mark.parametrize("interval", [0.1, 0.001])
def test_a_check_counts_samples(tmp_path, monkeypatch, interval):
    """One second for each, as is said here, and for each look at a plane."""
    monkeypatch.setattr(sampling, "_seconds", lambda *_: 1.0)
    names = [f"gauge.{name}.interval={interval}" for name in ("dam", "before", "crest")]
    scenario = scenario_of(tmp_path, STREAM, *names)
    found = estimate(scenario, *build_simulation(scenario))
    samples = 3 * (scenario.time_max / interval + 1)
    assert found.sampling == pytest.approx(samples + found.steps / LOOKS)
    assert found.seconds > found.sampling


def test_a_check_without_gauges_counts_none(tmp_path):
    text = STREAM[: STREAM.index("[gauge.crest]")]
    scenario = scenario_of(tmp_path, text)
    assert estimate(scenario, *build_simulation(scenario)).sampling == 0.0


def test_gauges_are_timed_within_the_flow(pool):
    """Which is far from them at first."""
    simulation, _, _ = pool
    place = np.array([50.0, 70.0])
    box = (place - 0.1).tolist(), (place + 0.1).tolist()
    assert not len(simulation.sample(*box)["mass"])
    there = sampling._FlowAt(simulation, simulation.state(), place).sample(*map(np.array, box))
    assert len(there["mass"]) > 50
    assert (there["motion"] != FIXED).all()
