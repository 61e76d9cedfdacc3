"""The gauge of a centre of mass: free fall, the ledger's momentum, periodic axes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from doseki.driver.gauges import build_gauges
from doseki.errors import UserError
from doseki.record.particles import BOUND, DRIVEN, FIXED, FREE
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

G, SPEED, HEAVY, LIGHT = 9.8, 0.7, 2750.0, 500.0
FALL = """\
dim = {dim}
dp = 0.02
time_max = 0.04
time_out = 0.02
time_history = 0.01
scheme = "{scheme}"
xi = 0.05
gravity = {{ d2 = [0, -9.8], d3 = [0, 0, -9.8] }}

[material.foam]
based_on = "basalt"
rho0 = 500

[body.stone]
shape = "{ball}"
material = "basalt"
centre = {{ d2 = [0, 1], d3 = [0, 0, 1] }}
radius = 0.05
velocity = {{ d2 = [0.7, 0], d3 = [0.7, 0, 0] }}

[body.cork]
shape = "box"
material = "foam"
min = {{ d2 = [0.4, 0.5], d3 = [0.4, 0, 0.5] }}
max = {{ d2 = [0.5, 0.6], d3 = [0.5, 0.1, 0.6] }}

[gauge.all]
kind = "mass_centre"
interval = 0.01

[gauge.stone]
kind = "mass_centre"
bodies = ["stone"]
interval = 0.01

[gauge.foam]
kind = "mass_centre"
material = "foam"
interval = 0.01
"""


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request):
    return request.param


@pytest.fixture(params=["ueta2022", "resolved"])
def fallen(request, dim, tmp_path):
    """The record of two bodies that fall side by side, each scheme in its way."""
    text = FALL.format(dim=dim, scheme=request.param, ball="disc" if dim == 2 else "sphere")
    (tmp_path / "fall.toml").write_text(text)
    run_scenario(load_scenario(str(tmp_path / "fall.toml")), tmp_path / "run")
    return load(tmp_path / "run")


def columns(record, *names):
    return np.stack([record[name] for name in names], axis=1)


def test_free_fall(fallen, dim):
    up = "xyz"[dim - 1]
    for name, x0, z0, speed in (("stone", 0.0, 1.0, SPEED), ("foam", 0.45, 0.55, 0.0)):
        record = fallen.gauges[name]
        t = record["time"]
        np.testing.assert_allclose(t, [0, 0.01, 0.02, 0.03, 0.04])
        np.testing.assert_allclose(record["x"], x0 + speed * t, atol=1e-9)
        np.testing.assert_allclose(record[up], z0 - 0.5 * G * t**2, atol=1e-9)
        np.testing.assert_allclose(record["velocity_x"], speed, atol=1e-9)
        np.testing.assert_allclose(record[f"velocity_{up}"], -G * t, atol=1e-9)


def test_all_is_the_mean_by_mass_not_by_number(fallen, dim):
    stone, foam, both = (fallen.gauges[name] for name in ("stone", "foam", "all"))
    names = "xyz"[:dim]
    m1, m2 = stone["mass"][:, None], foam["mass"][:, None]
    weighted = (m1 * columns(stone, *names) + m2 * columns(foam, *names)) / (m1 + m2)
    np.testing.assert_allclose(columns(both, *names), weighted, rtol=1e-12)
    last = fallen[-1]
    np.testing.assert_allclose(both["mass"], last["mass"].sum(), rtol=1e-12)
    by_number = last["position"].mean(axis=0)
    assert abs(by_number - weighted[-1]).max() > 0.01  # the control: what it must not be


def test_bodies_have_their_true_mass(fallen, dim):
    if fallen.scenario["scheme"] == "resolved":
        ball = np.pi * 0.05**2 if dim == 2 else 4 / 3 * np.pi * 0.05**3
        np.testing.assert_allclose(fallen.gauges["stone"]["mass"], HEAVY * ball)
        np.testing.assert_allclose(fallen.gauges["foam"]["mass"], LIGHT * 0.1**dim)


def test_mass_times_velocity_is_the_momentum_of_the_ledger(fallen, dim):
    gauge, history = fallen.gauges["all"], fallen.history
    rows = np.searchsorted(history["time"], gauge["time"] - 1e-9)
    np.testing.assert_allclose(history["time"][rows], gauge["time"], atol=1e-9)
    for axis in "xyz"[:dim]:
        momentum = gauge["mass"] * gauge[f"velocity_{axis}"]
        np.testing.assert_allclose(momentum, history[f"momentum_{axis}"][rows], atol=1e-9)


def test_momentum_of_water_that_splashes(tmp_path):
    """The same in a flow, where particles do not move alike and the walls do not count."""
    (tmp_path / "dam.toml").write_text(
        'extends = "dambreak"\ndp = 0.05\ntime_max = 0.1\ntime_out = 0.1\ntime_history = 0.02\n'
        '[gauge.water]\nkind = "mass_centre"\nmaterial = "water"\ninterval = 0.02\n'
    )
    run_scenario(load_scenario(str(tmp_path / "dam.toml")), tmp_path / "run")
    run = load(tmp_path / "run")
    gauge, history = run.gauges["water"], run.history
    rows = np.searchsorted(history["time"], gauge["time"] - 1e-9)
    momentum = gauge["mass"] * gauge["velocity_x"]
    np.testing.assert_allclose(momentum, history["momentum_x"][rows], rtol=1e-9, atol=1e-9)
    assert abs(momentum[-1]) > 0.1 * gauge["mass"][-1] * np.sqrt(G * 0.1)  # it flows


def frame(x, mass, motion, low=-10.0):
    """Particles along x at rest, of material 0; the last one of body 1."""
    n = len(x)
    position = np.stack([np.asarray(x, float), np.zeros(n)], axis=1)
    state = {
        "position": position, "velocity": 2 * position, "mass": np.asarray(mass, float),
        "motion": np.asarray(motion), "material": np.zeros(n, int),
        "body": np.array([0] * (n - 1) + [1]),
    }  # fmt: skip
    return SimpleNamespace(time=0.5, state=lambda: state)


@pytest.fixture
def read(tmp_path):
    """What a gauge reads from a frame."""

    def row(keys, simulation, top=""):
        text = FALL.format(dim=2, scheme="ueta2022", ball="disc").split("[gauge")[0]
        gauge = f'[gauge.g]\nkind = "mass_centre"\n{keys}\n'
        (tmp_path / "g.toml").write_text(f"{top}\n{text}{gauge}")
        scenario = load_scenario(str(tmp_path / "g.toml"))
        (reader,) = build_gauges(scenario, ["stone", "cork"])
        (found,) = reader.read(simulation)
        return dict(zip(reader.columns, found, strict=True))

    return row


def test_what_is_fixed_or_has_not_entered_does_not_count(read):
    still = frame([1, 3, 50, 70], [1, 3, 9, 9], [FREE, BOUND, FIXED, DRIVEN])
    found = read("", still)
    assert (found["mass"], found["x"], found["velocity_x"]) == (4, 2.5, 5)


def test_fixed_bodies_count_where_they_are_named(read):
    found = read('bodies = ["cork"]', frame([1, 3, 7], [1, 3, 9], [FREE, FREE, FIXED]))
    assert (found["mass"], found["x"]) == (9, 7)
    driven = read('bodies = ["cork"]', frame([1, 3, 7], [1, 3, 9], [FREE, FREE, DRIVEN]))
    assert driven["mass"] == 0
    assert np.isnan([driven["x"], driven["y"], driven["velocity_x"], driven["velocity_y"]]).all()


def test_a_file_counts_with_all_the_bodies_that_it_names(tmp_path):
    header, left = "x,y,vx,vy,mass,density,material,body", "0,0,1,0,1,1000,water,left"
    right = "3,0,4,0,2,1000,water,right"
    (tmp_path / "cloud.csv").write_text(f"{header}\n{left}\n{right}\n")
    (tmp_path / "cloud.toml").write_text(
        "dim = 2\ndp = 0.1\ntime_max = 1\ntime_out = 1\n"
        '[body.cloud]\nshape = "file"\nfile = "cloud.csv"\n'
        '[gauge.g]\nkind = "mass_centre"\nbodies = ["cloud"]\n'
    )
    scenario = load_scenario(str(tmp_path / "cloud.toml"))
    simulation, names = build_simulation(scenario)
    ((_, mass, x, _, speed, _),) = build_gauges(scenario, names)[0].read(simulation)
    assert (names, mass, x, speed) == (["left", "right"], 3, 2, 3)


def test_a_periodic_axis_has_a_circular_mean(read):
    domain = 'periodic = ["x"]\ndomain_min = [-2, -9]\ndomain_max = [2, 9]'
    across = frame([-1.9, 1.9, 1.8], [1, 1, 0.5], [FREE] * 3)
    inner = frame([0.1, -0.1, -0.2], [1, 1, 0.5], [FREE] * 3)
    shifted = read("", inner, domain)["x"] + 2
    assert shifted == pytest.approx(2 - 0.04, abs=1e-4)
    assert read("", across, domain)["x"] == pytest.approx(shifted, abs=1e-12)
    assert np.isnan(read("", frame([-1, 0, 1, 2], [1] * 4, [FREE] * 4), domain)["x"])
    assert read("", across)["x"] == pytest.approx(0.36)  # the control: an axis that is open


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ('bodies = ["stne"]', 'gauge.g.bodies: "stne" is not a known body; did you mean stone?'),
        ("bodies = []", "gauge.g.bodies"),
        ('material = "bsalt"', "did you mean basalt?"),
        ("position = [0, 0]", "gauge.g.position is not a known key"),
    ],
)
def test_wrong_keys(read, keys, said):
    with pytest.raises(UserError) as caught:
        read(keys, None)
    assert said in str(caught.value)


def test_it_is_drawn_and_sampled_by_the_core(read, fallen):
    scenario = load_scenario(str(fallen.folder.scenario))
    simulation, names = build_simulation(scenario)
    for gauge in build_gauges(scenario, names):
        ((time, mass, *rest),) = gauge.read(simulation)
        assert time == 0
        assert mass > 0
        assert np.isfinite(rest).all()
