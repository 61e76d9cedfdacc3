"""A plane sees each particle that crosses it, wherever what crossed it, or did not, leaves."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.overtopping import dam_balances
from doseki.record.particles import DRIVEN, FIXED
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.solver.build import build_simulation

from ..run.test_resume import stop_at
from .scenes import run_of, scenario_of

# Water and a stone on a ridge, from which they leave on both sides; the plane stands beside it.
TOP = """\
dim = 2
dp = 0.02
time_max = 0.5
time_out = 0.25
scheme = "resolved"
speed_max = 4
gravity = [0, -9.81]
{more}
[body.water]
shape = "box"
material = "water"
min = [0.2, 0.42]
max = [0.6, 0.56]

[body.stone]
shape = "disc"
material = "basalt"
centre = [0.74, 0.5]
radius = 0.06
velocity = [1.5, 0]

[gauge.crest]
kind = "overtopping"
position = [0.55, 0]
direction = [{way}, 0]
interval = 0.01
"""
RIDGE = '[terrain]\nfile = "ridge.csv"\nmaterial = "basalt"\nwall = "free_slip"\n'
BLOCK = """
[body.block]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [0, 1]
min = [0, 0.32]
max = [0.9, 0.42]
"""
LEFT = "[outflow.left]\nmin = [-9, -9]\nmax = [0.1, 9]\n"
RIGHT = "[outflow.right]\nmin = [0.8, -9]\nmax = [9, 9]\n"
ACROSS = "[outflow.across]\nmin = [0.5, 0.5]\nmax = [0.6, 9]\n"
INFLOW = """
[inflow.rain]
material = "water"
rate = 0.2
duration = 0.3
width = 1
depth = 0.08
position = [0.3, 0.7]
direction = [1, 0]
"""
SCENES = {
    "edges of a terrain": RIDGE,
    "the edge of a terrain and an outflow": RIDGE + LEFT,
    "outflows on both sides": BLOCK + LEFT + RIGHT,
    "an outflow across": BLOCK + LEFT + RIGHT + ACROSS,
    "an inflow": BLOCK + LEFT + RIGHT + INFLOW,
    "a period": 'periodic = ["x"]\ndomain_min = [0, 0.2]\ndomain_max = [0.9, 1.2]\n' + BLOCK,
}


def text_of(folder, name, way=1):
    (folder / "ridge.csv").write_text("x,z\n0,0.38\n0.3,0.42\n0.6,0.42\n0.9,0.3\n")
    return TOP.format(more=SCENES[name], way=way)


class Traced:
    """Mass on the sides of a plane, from where each particle was seen first and last."""

    def __init__(self, way):
        self.way, self.first, self.last, self.mass = way, {}, {}, {}

    def see(self, state):
        counts = (state["motion"] != FIXED) & (state["motion"] != DRIVEN)
        beyond = self.way * (state["position"][counts, 0] - 0.55) >= 0
        ids = state["id"][counts].tolist()
        for p, side, m in zip(ids, beyond.tolist(), state["mass"][counts], strict=True):
            self.first.setdefault(p, side)
            self.last[p], self.mass[p] = side, m
        return set(ids)

    @property
    def passed(self):
        return sum(m * (self.last[p] - self.first[p]) for p, m in self.mass.items())


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("name", [name for name in SCENES if name != "a period"])
def test_what_passed_is_what_went_through(tmp_path, name, way):
    simulation, _ = build_simulation(scenario_of(tmp_path, text_of(tmp_path, name, way)))
    traced = Traced(way)
    start = traced.see(simulation.state())
    (at_once,) = simulation.totals()["plane_supplied"]  # less what began in an outflow
    while simulation.time < 0.5:
        simulation.advance(limit=0.5, pause=0.5, max_steps=1)
        there = traced.see(simulation.state())
    totals = simulation.totals()
    assert len(set(traced.last) - there) > 40  # left
    assert abs(traced.passed) > 1
    assert totals["plane_mass"] == [pytest.approx(traced.passed, rel=1e-9)]
    came = sum(traced.mass[p] for p in set(traced.first) - start if not traced.first[p])
    left = sum(traced.mass[p] for p in set(traced.last) - there if not traced.last[p])
    assert totals["plane_supplied"] == [pytest.approx(at_once + came - left, abs=1e-9)]
    density = totals["plane_mass"][0] / totals["plane_volume"][0]
    assert 950 < density < 2900  # a part of it is stone


@pytest.mark.parametrize("name", SCENES)
def test_masses_close(tmp_path, name):
    """Three counts that do not follow from one another: what is upstream, came there, passed."""
    run = run_of(tmp_path, text_of(tmp_path, name))
    record = run.gauges["crest"]
    upstream = record["mass_upstream"]
    residual = upstream[0] + record["mass_supplied"] - record["mass_passed"] - upstream
    assert np.abs(residual).max() < 1e-9 * upstream[0]
    assert np.ptp(record["mass_passed"]) > 1
    # All of it goes above the position, which lies below everything.
    np.testing.assert_allclose(record["mass_over"], record["mass_passed"], atol=1e-9 * upstream[0])
    over, passed = record["volume_over"], record["volume_passed"]
    np.testing.assert_allclose(over, passed, rtol=1e-3, atol=1e-5 * record["volume_upstream"][0])
    (dam,) = dam_balances(run)
    assert abs(dam.residual) < 1e-9 * upstream[0]


@pytest.mark.parametrize("name", ["edges of a terrain", "a period"])
def test_a_resumed_run_counts_on(tmp_path, name):
    scenario = scenario_of(tmp_path, text_of(tmp_path, name))
    run_scenario(scenario, tmp_path / "straight", RunOptions(threads=1))
    for time in (0.113, 0.307):
        options = RunOptions(threads=1, progress=stop_at(tmp_path / "run", time))
        if time < 0.2:
            run_scenario(scenario, tmp_path / "run", options)
        else:
            resume_run(tmp_path / "run", (), options)
    resume_run(tmp_path / "run", (), RunOptions(threads=1))
    straight, run = (load(tmp_path / where) for where in ("straight", "run"))
    for column, values in straight.gauges["crest"].items():
        np.testing.assert_array_equal(run.gauges["crest"][column], values)


def test_a_run_that_starts_from_another_counts_anew(tmp_path):
    """From its first sample, also where it goes on from a checkpoint."""
    text = text_of(tmp_path, "edges of a terrain")
    run_scenario(scenario_of(tmp_path, text), tmp_path / "first", RunOptions(threads=1))
    start = '[start]\nfrom = "first"\n'
    scenario = scenario_of(tmp_path, text.replace("[body.water]", f"{start}\n[body.water]"),
                           "time_max=0.6")  # fmt: skip
    run_scenario(scenario, tmp_path / "second", RunOptions(threads=1))
    record = load(tmp_path / "second").gauges["crest"]
    assert record["mass_passed"][0] == record["mass_supplied"][0] == 0
    upstream = record["mass_upstream"]
    residual = upstream[0] + record["mass_supplied"] - record["mass_passed"] - upstream
    assert np.abs(residual).max() < 1e-9 * max(upstream[0], 1)
