"""The gauge of motion: where bodies are, how fast and turned, and what pushes them, as means."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.driver.means import Means
from doseki.errors import UserError
from doseki.figures.kinds.registry import draw
from doseki.measure.views import tables
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.scenario.tables.figure import Figure
from doseki.solver.build import build_simulation

from ..run.test_resume import stop_at

G = 9.8
FLIGHT = """\
dim = {dim}
dp = 0.02
time_max = 0.04
time_out = 0.04
scheme = "resolved"
xi = 0.05
gravity = {{ d2 = [0, -9.8], d3 = [0, 0, -9.8] }}

[body.stone]
shape = {{ d2 = "disc", d3 = "sphere" }}
material = "basalt"
centre = {{ d2 = [0, 1], d3 = [0, 0, 1] }}
radius = 0.05
velocity = {{ d2 = [0.7, 0], d3 = [0.7, 0, 0] }}
spin = {{ d2 = -100, d3 = [0, 100, 0] }}

[gauge.stone]
kind = "motion"
bodies = ["stone"]
interval = 0.01
"""
# A block that rests on the floor of a tank, and grains that fall in.
TANK = """\
dim = 2
dp = 0.02
time_max = 0.2
time_out = 0.1
scheme = "resolved"
speed_max = 2
cflnumber = 0.2
uplift = false
gravity = [0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.06, -0.06]
max = [0.46, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.06, 0]
max = [0, 0.4]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
min = [0.4, 0]
max = [0.46, 0.4]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.2]

[body.block]
shape = "box"
material = "basalt"
min = [0.14, 0]
max = [0.26, 0.1]

[body.rain]
shape = "disc"
material = "basalt"
d = 0.04
count = 6
min = [0, 0.22]
max = [0.4, 0.32]
velocity = [0, -1]

[gauge.block]
kind = "motion"
bodies = ["block"]
interval = 0.01

[gauge.some]
kind = "motion"
bodies = ["rain"]
grains = [4, 1]
interval = 0.02

[gauge.all]
kind = "motion"
bodies = ["block", "rain"]

[figure.some]
kind = "gauge"
gauge = "some"
"""


def scenario_of(folder, text):
    (folder / "case.toml").write_text(text)
    return load_scenario(str(folder / "case.toml"))


def columns(record, name, dim=2):
    return np.stack([record[f"{name}_{axis}"] for axis in "xyz"[:dim]], axis=1)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_stone_in_flight(tmp_path, dim):
    run_scenario(scenario_of(tmp_path, FLIGHT.format(dim=dim)), tmp_path / "run")
    record = load(tmp_path / "run").gauges["stone"]
    t, up = record["time"], "xyz"[dim - 1]
    np.testing.assert_allclose(t, [0, 0.01, 0.02, 0.03, 0.04])
    np.testing.assert_allclose(record["x"], 0.7 * t, atol=1e-12)
    np.testing.assert_allclose(record[up], 1 - 0.5 * G * t**2, atol=1e-9)
    np.testing.assert_allclose(record[f"velocity_{up}"], -G * t, atol=1e-9)
    for force in ("flow_force", "contact_force"):
        assert np.isnan(columns(record, force, dim)[0]).all()
        assert np.array_equal(columns(record, force, dim)[1:], np.zeros((4, dim)))
    unit = "N/m" if dim == 2 else "N"
    assert record.units["flow_force_x"] == record.units["contact_force_x"] == unit
    if dim == 2:  # 4 rad, the other way round
        np.testing.assert_allclose(np.unwrap(record["angle"]), -100 * t, atol=1e-6)
        np.testing.assert_allclose(record["spin"], -100)
    else:
        np.testing.assert_allclose(np.abs(record["orientation_w"]), abs(np.cos(50 * t)), atol=1e-6)
        np.testing.assert_allclose(np.abs(record["orientation_y"]), abs(np.sin(50 * t)), atol=1e-6)
        np.testing.assert_allclose(columns(record, "spin", 3), [[0, 100, 0]] * 5, atol=1e-9)


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tank")
    run_scenario(scenario_of(folder, TANK), folder / "run", RunOptions(threads=1))
    return folder / "run"


def test_mean_forces_are_what_changes_the_velocity(tank):
    """m dv = (flow + contact + m g) dt, to rounding, whatever happens between two samples."""
    run = load(tank)
    mass = dict(zip(run[0].grains["body"], run[0].grains["mass"], strict=True))
    met = 0.0
    for name, body, grain in (("block", "block", 0), ("some", "rain", 5), ("some", "rain", 2)):
        rows = run.gauges[name]["grain"] == grain
        record = {key: values[rows] for key, values in run.gauges[name].items()}
        change = np.diff(columns(record, "velocity"), axis=0) / np.diff(record["time"])[:, None]
        pushed = columns(record, "flow_force") + columns(record, "contact_force")
        gained = pushed[1:] / mass[body] + [0, -G]
        np.testing.assert_allclose(change, gained, atol=1e-8 * G)
        met = max(met, np.abs(columns(record, "contact_force")[1:]).max() / mass[body] / G)
    assert met > 1  # they do touch something


def test_a_block_at_rest_presses_with_its_weight_and_the_water_above(tank):
    """No water is below it, so that it is pressed down, not up."""
    run = load(tank)
    record, first = run.gauges["block"], run[0].grains
    weight = first["mass"][0] * G
    assert abs(record["y"] - record["y"][0]).max() < 1e-3
    at_rest = (record["time"] > 0.045) & (record["time"] < 0.185)  # then a grain strikes it
    balance = (record["flow_force_y"] + record["contact_force_y"])[at_rest] / weight
    assert balance.mean() == pytest.approx(1, abs=0.02)
    above = 1000 * G * 0.12 * 0.1
    assert record["contact_force_y"][at_rest].mean() > weight + 0.5 * above


def test_the_contact_force_of_a_step_is_its_mean(tmp_path):
    """Between the kicks of the water a body swings; that of the last instant was twice as much."""
    scenario = scenario_of(tmp_path, TANK)
    simulation, _ = build_simulation(scenario)
    simulation.advance(limit=1, pause=0.05, max_steps=10**6)
    for _ in range(5):
        before = simulation.grains()
        simulation.advance(limit=1, pause=1, max_steps=1)
        table = simulation.grains()
        impulse = table["contact_impulse"] - before["contact_impulse"]
        np.testing.assert_allclose(
            table["contact_force"][0], impulse[0] / simulation.timestep, rtol=1e-6
        )
        gained = table["velocity"][0] - before["velocity"][0]
        flow = 0.5 * simulation.timestep * (before["flow_force"] + table["flow_force"])[0]
        asked = table["mass"][0] * (gained + simulation.timestep * np.array([0, G])) - flow
        np.testing.assert_allclose(impulse[0], asked, atol=1e-9 * np.abs(asked).max())


def test_rows_are_the_grains_of_the_snapshots(tank):
    run = load(tank)
    assert run.gauges["some"]["grain"][:4].tolist() == [5, 2, 5, 2]  # the block is the first
    every = run.gauges["all"]
    assert len(every["time"]) == 7 * len(run)
    for snapshot in run:
        rows = every["time"] == snapshot.time
        assert every["grain"][rows].tolist() == list(range(7))
        here = np.stack([every["x"][rows], every["y"][rows]], axis=1)
        assert np.array_equal(here, snapshot.grains["position"])
        assert np.array_equal(every["spin"][rows], snapshot.grains["spin"][:, 2])


def test_each_grain_has_a_curve(tank):
    run = load(tank)
    figure = draw(run, "some", tables(run, "figure", Figure)["some"])
    assert len(figure.axes) == 8
    assert [line.get_label() for line in figure.axes[0].lines] == ["grain 2", "grain 5"]
    times = run.gauges["some"]["time"]
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_xdata(), np.unique(times))


def test_a_resumed_run_has_the_rows_of_one_that_was_never_interrupted(tmp_path, tank):
    """Stopped between two samples; what a mean is made of stands in the checkpoint."""
    options = {"threads": 1, "checkpoint_every": 0.001}
    stop = stop_at(tmp_path / "run", 0.0523)
    scenario = scenario_of(tmp_path, TANK)
    run_scenario(scenario, tmp_path / "run", RunOptions(progress=stop, **options))
    assert load(tmp_path / "run").gauges["block"]["time"][-1] < 0.06
    resume_run(tmp_path / "run", (), RunOptions(**options))
    for name in ("block", "some", "all"):
        file = f"gauges/{name}.csv"
        assert (tmp_path / "run" / file).read_bytes() == (tank / file).read_bytes()


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('bodies = ["floor"]', 'floor" is no rigid body that moves.*kind = "force"'),
        ('bodies = ["water"]', 'water" is no rigid body that moves.*kind = "mass_centre"'),
        ('bodies = ["blok"]', "did you mean block"),
        ('bodies = ["rain"]\ngrains = [1, 6]', "no grain 6; rain has 6, from 0 to 5"),
        ('bodies = ["rain"]\ngrains = [-1]', "grains"),
        ('bodies = ["rain"]\ngrains = []', "grains"),
        ("", "bodies is missing"),
        ('bodies = ["rain"]\ninterval = 1e-7', "interval"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, table, said):
    text = f'{TANK}\n[gauge.bad]\nkind = "motion"\n{table}\n'
    with pytest.raises(UserError, match=said):
        build_simulation(scenario_of(tmp_path, text))


def test_what_is_kept_of_another_gauge_is_refused(tmp_path):
    reader = type("Reader", (), {"mean_columns": 4, "name": "g"})
    means = Means(reader)
    with pytest.raises(ValueError, match="the gauge g has 4 numbers"):
        means.state = [0.0] * 4
    means.state = [0.0] * 9
    assert means.state == [0.0] * 9
