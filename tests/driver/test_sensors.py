"""Gauges that see what a sensor sees: its face and its bandwidth."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from doseki.driver.active_run import ActiveRun
from doseki.driver.gauges import build_gauges
from doseki.driver.sensors import Sensor
from doseki.errors import UserError
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.gauges.face import Face
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, filled_simulation
from doseki.util.low_pass import low_passed

DP, FIXED = 0.01, 1
TANK = """\
dim = 2
dp = 0.02
time_max = 0.03
time_out = 0.03
scheme = "resolved"
speed_max = 1.5
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
normal = [1, 0]
min = [-0.06, 0]
max = [0, 0.4]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
normal = [-1, 0]
min = [0.4, 0]
max = [0.46, 0.4]
{motion}

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.3]
velocity = [{speed}, 0]

[gauge.g]
kind = "pressure"
{gauge}
"""
SENSOR = "position = [0.4, 0.1]\narea = 0.1\n"


def tank_file(folder, gauge, motion="", speed=0.0, more=""):
    file = folder / "tank.toml"
    file.write_text(TANK.format(gauge=gauge, motion=motion, speed=speed) + more)
    return file


def wall(dim, turn=0.0):
    """Three layers of a wall below z = 0, turned about the y axis."""
    side = DP * (np.arange(-30, 30) + 0.5)
    axes = [side] * (dim - 1) + [-DP * (np.arange(3) + 0.5)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, dim)
    normal = np.zeros_like(x)
    normal[:, -1] = 1.0
    c, s = np.cos(turn), np.sin(turn)
    R = np.eye(dim)
    R[0, 0], R[0, -1], R[-1, 0], R[-1, -1] = c, -s, s, c
    return {
        "position": x @ R.T, "normal": normal @ R.T, "depth": -x[:, -1],
        "motion": np.full(len(x), FIXED),
    }  # fmt: skip


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("turn", [0.0, 0.4])
@pytest.mark.parametrize("across", [0.3, 1.0, 4.7, 20.0])
def test_the_mean_over_a_face_is_that_in_its_middle(dim, turn, across):
    """Wherever it is among the particles, to a tenth of a spacing."""
    state = wall(dim, turn)
    size = across * DP
    area = size if dim == 2 else np.pi * size**2 / 4
    for place in (0.0, 0.3 * DP, 0.5 * DP):
        middle = np.zeros(dim)
        middle[0], middle[-1] = place * np.cos(turn), place * np.sin(turn)
        face = Face(middle, area, DP)
        weights = face.weights(state)
        assert face.diameter == pytest.approx(size)
        tangent = np.zeros(dim)
        tangent[0], tangent[-1] = np.cos(turn), np.sin(turn)
        mean = weights @ (state["position"] @ tangent) / weights.sum()
        assert mean == pytest.approx(place, abs=0.1 * DP)
        assert face.covered(state) == pytest.approx(1, abs=0.2 if dim == 3 else 1e-9)


def test_a_face_that_is_half_off_its_wall_is_not_covered():
    face = Face(np.array([0.3, 0.0]), 0.1, DP)
    assert face.covered(wall(2)) == pytest.approx(0.5)
    assert Face(np.array([0.0, 0.05]), 0.1, DP).covered(wall(2)) == 0.0


def test_a_face_knows_its_wall_beside_a_corner():
    """A floor meets a wall: each face is of the one whose surface it lies on."""
    floor, side = wall(2), wall(2, np.pi / 2)
    both = {key: np.concatenate([floor[key], side[key]]) for key in floor}
    on_floor = Face(np.array([-0.003, 0.0]), 0.001, DP).weights(both)
    on_side = Face(np.array([0.0, 0.003]), 0.001, DP).weights(both)
    n = len(floor["depth"])
    assert on_floor[:n].sum() > 0.9
    assert on_floor[n:].sum() == 0
    assert on_side[n:].sum() > 0.9
    assert on_side[:n].sum() == 0
    told = Face(np.array([0.0, 0.0]), 0.001, DP, np.array([0.0, 2.0])).weights(both)
    assert told[n:].sum() == 0


def test_a_face_at_an_edge_has_the_particles_of_the_edge():
    """Whichever of the two faces these say they belong to."""
    state = wall(2)
    end = state["position"][:, 0] > 0.29
    state["normal"][end] = [1.0, 0.0]
    state["depth"][end] = 0.3 - state["position"][end, 0]
    face = Face(np.array([0.298, 0.0]), 0.001, DP, np.array([0.0, 1.0]))
    assert face.covered(state) == pytest.approx(0.7)


def test_a_filtered_gauge_shows_what_the_filter_makes_of_every_step(tmp_path):
    """The interval changes what is written, not what is read."""
    more = f'\n[gauge.rare]\nkind = "pressure"\n{SENSOR}filter_hz = 60\ninterval = 0.03\n'
    file = tank_file(tmp_path, SENSOR + "filter_hz = 60\ninterval = 0.01", speed=0.3, more=more)
    scenario = load_scenario(str(file))
    simulation, names = build_simulation(scenario)
    raw = {gauge.name: gauge for gauge in build_gauges(scenario, names)}["rare"]
    seen = [raw.read(simulation)[0]]
    limits = iter((0.01, 0.02, 0.03))
    limit = next(limits)
    while simulation.time < 0.03:
        simulation.advance(limit=limit, pause=limit, max_steps=1)
        seen.append(raw.read(simulation)[0])
        limit = next(limits, limit) if simulation.time >= limit else limit
    times, pressure = np.array(seen).T
    shown = low_passed(times, pressure, 60.0)
    run_scenario(scenario, tmp_path / "run", RunOptions(threads=1))
    gauges = load(tmp_path / "run").gauges
    for name in ("g", "rare"):
        record = gauges[name]
        k = np.searchsorted(times, record["time"])
        np.testing.assert_array_equal(record["pressure"], shown[k])
        np.testing.assert_array_equal(record["raw"], pressure[k])
        assert record["peak"].max() == shown.max()
        impulse = np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(times))
        assert record["impulse"][-1] == pytest.approx(impulse, rel=1e-12)
    assert gauges["rare"].units == {
        "time": "s", "pressure": "Pa", "peak": "Pa", "raw": "Pa", "impulse": "Pa s",
    }  # fmt: skip
    assert pressure.max() > 1.1 * shown.max()  # else the filter would have nothing to do


@pytest.mark.parametrize(
    ("place", "share", "error"),
    [("[0.4, 0.15]\narea = 0.3", 0.5, 0.03), ("[0.2, 0]\narea = 0.1", 1.0, 0.015)],
)
def test_a_face_reads_the_load_of_a_tank_at_rest(tmp_path, place, share, error):
    """On a wall over its height half of that at its foot, which is what the floor bears."""
    scenario = load_scenario(str(tank_file(tmp_path, f"position = {place}")))
    simulation, names = build_simulation(scenario)
    (gauge,) = build_gauges(scenario, names)
    pressure = []
    for time in np.linspace(0.005, 0.6, 120):
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        pressure.append(gauge.read(simulation)[0][1])
    assert np.mean(pressure) == pytest.approx(share * 9800 * 0.3, rel=error)


def test_a_sensor_goes_on_where_it_was():
    class Reader:
        name = "g"

        def read(self, now):
            return [[now.time, np.sin(40 * now.time)]]

    straight, first = Sensor(Reader(), 5.0), Sensor(Reader(), 5.0)
    times = np.cumsum(np.random.default_rng(3).uniform(0, 0.01, 100))
    for time in times[:50]:
        straight.follow(SimpleNamespace(time=time))
        first.follow(SimpleNamespace(time=time))
    second = Sensor(Reader(), 5.0)
    second.state = first.state
    for time in times[50:]:
        straight.follow(SimpleNamespace(time=time))
        second.follow(SimpleNamespace(time=time))
    assert second.state == straight.state
    assert second.row() == straight.row()


def test_a_sensor_of_a_run_that_starts_late_has_no_impulse_of_before():
    class Reader:
        name = "g"

        def read(self, now):
            return [[now.time, 2000.0]]

    sensor = Sensor(Reader(), 5.0)
    for time in (3.5, 3.6, 3.8):
        sensor.follow(SimpleNamespace(time=time))
    assert sensor.row()[-1] == pytest.approx(0.3 * 2000.0)


def test_a_run_without_sensors_takes_no_single_steps(tmp_path):
    class Simulation:
        time = 0.0

        def advance(self, limit, pause, max_steps):
            self.steps = max_steps

    run = SimpleNamespace(stride=None, simulation=Simulation())
    ActiveRun._step(run, 1.0, 1.0, 1000)
    assert run.simulation.steps == 1000


@pytest.mark.parametrize(
    ("gauge", "motion", "parts"),
    [
        ("position = [0.4, 0.1]\narea = 0", "", ["area = 0 is out of range"]),
        ("position = [0.4, 0.3]\narea = 0.4", "", ["area = 0.4 is larger than the wall", "75 %"]),
        ("position = [0.3, 0.1]\narea = 0.01", "", ["is not on the surface of a fixed body"]),
        (SENSOR + "radius = 0.1", "", ["gauge.g.radius: a gauge with area"]),
        (SENSOR + 'material = "water"', "", ["gauge.g.material: a gauge with area"]),
        ("position = [0.4, 0.1]\ndirection = [1, 0]", "", ["direction: only a gauge with area"]),
        (SENSOR + "filter_hz = -1", "", ["filter_hz = -1 is out of range"]),
        (SENSOR + "filter_hz = 1e5", "", ["filter_hz = 100000 Hz is more than steps can show"]),
        (SENSOR, "motion = { velocity = [0, 1] }", ['its wall "right" moves']),
    ],
)
def test_wrong_sensors(tmp_path, gauge, motion, parts):
    with pytest.raises(UserError) as caught:
        filled_simulation(load_scenario(str(tank_file(tmp_path, gauge, motion))))
    for part in ("tank.toml", *parts):
        assert part in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_face_needs_a_scheme_that_has_a_pressure_of_walls(tmp_path):
    file = tank_file(tmp_path, SENSOR)
    text = file.read_text().replace('scheme = "resolved"\nspeed_max = 1.5\n', "xi = 0.05\n")
    file.write_text(text.replace("normal = [1, 0]\n", "").replace("normal = [-1, 0]\n", ""))
    with pytest.raises(UserError, match=r'area needs scheme = "resolved"; ueta2022 has'):
        load_scenario(str(file))


@pytest.mark.parametrize(("area", "doubted"), [(0.08, True), (0.2, False)])
def test_a_sensor_smaller_than_the_kernel_is_doubted(tmp_path, area, doubted):
    gauge = f"position = [0.4, 0.15]\narea = {area}"
    warnings = filled_simulation(load_scenario(str(tank_file(tmp_path, gauge)))).warnings
    found = [str(warning) for warning in warnings if "a sensor" in str(warning)]
    assert len(found) == doubted
    if doubted:
        assert "gauge.g: a sensor 0.08 m across" in found[0]
        assert "would resolve it" in found[0]
