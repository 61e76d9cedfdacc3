"""The load in parts: they add up, and their impulses are those that the flow and bodies lose."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.driver.gauges import build_gauges
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.solver.build import build_simulation

from ..run.test_resume import stop_at
from .scenes import RAIN, run_of, scenario_of

NAMES = ("force_x", "force_y", "moment")
BLOCK = """\
dim = 2
dp = 0.02
time_max = 0.3
time_out = 0.3
scheme = "resolved"
speed_max = 2
gravity = [0, -9.8]

[body.table]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.4, -0.2]
max = [0.4, 0]

[body.block]
shape = "box"
material = "basalt"
min = [0.1, 0]
max = [0.26, 0.16]

[gauge.table]
kind = "load"
bodies = ["table"]
about = [0.18, 0]
interval = 0.02

[gauge.top]
kind = "panels"
bodies = ["table"]
origin = [-0.4, 0]
edges = [[0.8, 0]]
panels = [8]
direction = [0, 1]
interval = 0.02
"""
SPHERE = """\
dim = 3
dp = 0.02
time_max = 0.03
time_out = 0.03
scheme = "resolved"
speed_max = 4
gravity = [0, 0, 0]

[body.wall]
shape = "box"
material = "aluminium"
fixed = true
min = [0, -0.2, -0.2]
max = [0.16, 0.2, 0.2]

[body.ball]
shape = "sphere"
material = "basalt"
centre = [-0.062, 0.1, 0]
radius = 0.05
velocity = [3, 0, 0]

[gauge.wall]
kind = "load"
bodies = ["wall"]
interval = 0.01

[gauge.front]
kind = "panels"
bodies = ["wall"]
origin = [0, -0.2, -0.2]
edges = [[0, 0.4, 0], [0, 0, 0.4]]
panels = [4, 2]
direction = [-1, 0, 0]
interval = 0.01
"""


@pytest.fixture(scope="module")
def rain(tmp_path_factory):
    return run_of(tmp_path_factory.mktemp("rain"), RAIN)


def test_parts_add_up_to_the_total(rain):
    for gauge in ("all", "sill"):
        record = rain.gauges[gauge]
        assert np.abs(record["contact_force_y"][1:]).max() > 10
        assert np.abs(record["static_force_y"][1:]).max() > 10
        for name in NAMES:
            parts = sum(record[f"{part}_{name}"] for part in ("static", "dynamic", "contact"))
            scale = np.nanmax(np.abs(record[name]))
            np.testing.assert_allclose(parts[1:], record[name][1:], atol=1e-12 * scale)


def test_the_impulse_is_what_flow_and_bodies_do_not_keep(rain):
    """Weight less the change of momentum, whatever collides between two samples."""
    record, history = rain.gauges["all"], rain.history
    steps = np.diff(record["time"])
    mass, end = history["mass"][0], history["time"][-1]
    for axis, pull in (("x", 0.0), ("y", -9.8)):
        pushed = float(steps @ record[f"force_{axis}"][1:])
        gained = history[f"momentum_{axis}"][-1] - history[f"momentum_{axis}"][0]
        assert pushed == pytest.approx(mass * pull * end - gained, abs=1e-9 * mass * 9.8 * end)


def test_means_do_not_depend_on_the_interval(rain):
    """A mean over twelve samples is the mean of those twelve."""
    often, rare = rain.gauges["all"], rain.gauges["rare"]
    for name in ("force_x", "force_y", "contact_force_y", "contact_moment", "moment"):
        means = often[name][1:].reshape(2, 12).mean(axis=1)
        np.testing.assert_allclose(rare[name][1:], means, rtol=1e-9, atol=1e-9)


def test_the_static_part_is_the_mean_of_both_ends(rain, tmp_path):
    """Of each row: from the water at the start and rows of 0.01 s follows that of 0.12 s."""
    scenario = scenario_of(tmp_path, RAIN)
    simulation, names = build_simulation(scenario)
    reader = {gauge.name: gauge for gauge in build_gauges(scenario, names)}["all"]
    far = np.full(2, np.inf)
    now = reader.gauge.static(simulation, reader.setting, (-far, far))
    often, rare = (
        np.stack([rain.gauges[gauge][f"static_{name}"] for name in NAMES], axis=1)[1:]
        for gauge in ("all", "rare")
    )
    first = now
    for mean in often[:12]:
        now = 2 * mean - now
    np.testing.assert_allclose(0.5 * (first + now), rare[0], atol=1e-9 * np.abs(rare[0]).max())
    assert np.abs(now - first).max() > 0.05 * np.abs(rare[0]).max()


def test_the_peak_is_no_less_than_any_mean(rain):
    """It is the largest of steps, so that at least one step of a sample reaches the mean."""
    record = rain.gauges["sill"]
    size = [
        np.hypot(*(record[f"{part}force_{axis}"][1:] for axis in "xy")) for part in ("", "peak_")
    ]
    assert (size[1] >= size[0] * (1 - 1e-12)).all()
    assert size[1].max() > 1.5 * size[0].max()
    late = record["peak_time"][1:] <= record["time"][1:] + 1e-12
    early = record["peak_time"][1:] > record["time"][:-1]
    assert (late & early).all()


def test_a_block_rests_with_its_weight(tmp_path):
    """As the grain part, under its middle, when it no longer swings on its springs.

    The control has a block of another material.
    """
    run = run_of(tmp_path, BLOCK)
    record, weight = run.gauges["table"], 0.16**2 * 2750 * 9.8
    np.testing.assert_allclose(record["contact_force_y"][10:], -weight, rtol=1e-6)
    np.testing.assert_allclose(record["force_y"], record["contact_force_y"])
    np.testing.assert_allclose(record["contact_moment"][10:], 0, atol=1e-6 * weight)
    for name in ("static_force_y", "dynamic_force_y"):
        assert not record[name][1:].any()
    pressure = run.gauges["top"]["contact_pressure"].reshape(-1, 8)[1:]
    np.testing.assert_allclose(pressure.sum(axis=1) * 0.1, -record["contact_force_y"][1:])
    assert not pressure[:, [0, 1, 2, 3, 4, 7]].any()
    (tmp_path / "other").mkdir()
    heavy = run_of(tmp_path / "other", BLOCK, "material.basalt.rho0=2800").gauges["table"]
    assert heavy["contact_force_y"][-1] == pytest.approx(-weight * 2800 / 2750, rel=1e-6)


def test_a_ball_that_hits_a_wall(tmp_path):
    """The impulse is twice its momentum less what restitution takes; the hit is at its speed."""
    run = run_of(tmp_path, SPHERE)
    record = run.gauges["wall"]
    grains = run[0].grains, run[-1].grains
    mass = grains[0]["mass"][0]
    change = grains[1]["velocity"][0] - grains[0]["velocity"][0]
    impulse = np.diff(record["time"]) @ record["contact_force_x"][1:]
    assert change[0] < -4
    assert impulse == pytest.approx(-mass * change[0], rel=1e-9)
    assert record["hit_speed"].max() == pytest.approx(3, rel=1e-3)
    assert record["hit_radius"][np.argmax(record["hit_speed"])] == pytest.approx(0.05)
    turned = np.diff(record["time"]) @ record["contact_moment_z"][1:]
    assert turned == pytest.approx(-0.1 * impulse, rel=1e-6)
    front = run.gauges["front"]["contact_pressure"].reshape(-1, 2, 4)[1:] * 0.1 * 0.2
    np.testing.assert_allclose(front.sum(axis=(1, 2)), record["contact_force_x"][1:], rtol=1e-9)
    summed = front.sum(axis=0)
    assert summed[1, 2] + summed[1, 3] == pytest.approx(summed.sum(), rel=1e-9)


def test_the_same_bits_on_any_number_of_threads_and_after_a_stop(tmp_path, rain):
    scenario = scenario_of(tmp_path, RAIN)
    options = {"threads": 2, "checkpoint_every": 0.001}
    stop = stop_at(tmp_path / "run", 0.1033)
    run_scenario(scenario, tmp_path / "run", RunOptions(progress=stop, **options))
    assert load(tmp_path / "run").gauges["sill"]["time"][-1] < 0.11
    resume_run(tmp_path / "run", (), RunOptions(**options))
    for name in ("all", "rare", "sill", "top", "crest"):
        file = f"gauges/{name}.csv"
        assert (tmp_path / "run" / file).read_bytes() == (rain.directory / file).read_bytes(), name


@pytest.mark.parametrize("rolling", [0.0, 0.4])
def test_the_turning_is_what_grains_lose(tmp_path, rolling):
    """Of discs that hit, slide and roll without gravity: angular momentum, about a point."""
    water = RAIN[RAIN.index("[body.water]") : RAIN.index("[body.rain]")]
    text = RAIN.replace(water, "").replace("[0, -9.8]", "[0, 0]")
    text = text.replace("velocity = [0, -1.5]", "velocity = [1.2, -2]\nspin = 40")
    run = run_of(tmp_path, text, f"material.basalt.rolling_friction={rolling}")
    about = np.array([0.3, 0.1])

    def turning(grains):
        arm = grains["position"] - about
        v, mass, radius = grains["velocity"], grains["mass"], 0.5 * grains["diameter"]
        orbital = mass * (arm[:, 0] * v[:, 1] - arm[:, 1] * v[:, 0])
        return float(np.sum(orbital + 0.5 * mass * radius**2 * grains["spin"][:, 2]))

    record = run.gauges["all"]
    given = np.diff(record["time"]) @ record["contact_moment"][1:]
    lost = turning(run[0].grains) - turning(run[-1].grains)
    assert abs(lost) > 0.2 * abs(turning(run[0].grains))
    assert given == pytest.approx(lost, rel=1e-9)
    np.testing.assert_array_equal(record["contact_moment"], record["moment"])


def test_a_force_has_the_contacts_beside_it(tmp_path):
    """Those that a load has, at the same times; the flow alone is what the particles say."""
    force = '\n[gauge.force]\nkind = "force"\nbodies = ["sill"]\ninterval = 0.01\n'
    gauges = run_of(tmp_path, RAIN + force, "time_max=0.12").gauges
    columns = ("contact_force_x", "contact_force_y", "contact_moment")
    for column in columns:
        np.testing.assert_array_equal(gauges["force"][column], gauges["sill"][column])
    assert np.isnan(gauges["force"]["contact_force_y"][0])
    assert gauges["force"]["contact_force_y"][1:].min() < -10
