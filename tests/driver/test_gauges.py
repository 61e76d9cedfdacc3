"""Gauges: what they read in flows that are known exactly."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from doseki.assess.warnings import GaugeOutside, findings
from doseki.driver.gauges import build_gauges
from doseki.errors import UserError
from doseki.scenario.gauges.loads.force import Force, force_and_moment
from doseki.scenario.gauges.near import kernel
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

DP, DEPTH, SHEAR = 0.02, 0.2, 3.0
FREE, FIXED, BOUND = 0, 1, 3
TOP = """\
dim = {dim}
dp = 0.02
time_max = 1
time_out = 0.5
xi = 0.05
{top}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
min = {{ d2 = [0, -0.06], d3 = [0, 0, -0.06] }}
max = {{ d2 = [0.4, 0], d3 = [0.4, 0.4, 0] }}

[body.water]
shape = "box"
material = "water"
min = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
max = {{ d2 = [0.4, 0.2], d3 = [0.4, 0.4, 0.2] }}

[gauge.g]
"""


class StillFrame:
    """A simulation that does not run: particles as they are."""

    def __init__(self, **fields: np.ndarray) -> None:
        self.fields, self.time = fields, 0.25

    def sample(self, low, high):
        position = self.fields["position"]
        inside = ((position >= low) & (position <= high)).all(axis=1)
        return {name: values[inside] for name, values in self.fields.items()}


def frame(dim, keep=lambda x: np.ones(len(x), bool), jitter=0.0):
    """Water in linear shear over a bed, 0.4 m square; `keep` tells which water there is."""
    counts = [20] * (dim - 1)
    axes = [DP * (np.arange(n) + 0.5) for n in counts]
    axes.append(DP * (np.arange(-3, round(DEPTH / DP)) + 0.5))
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, dim)
    x = x[(x[:, -1] < 0) | keep(x)]
    wall = x[:, -1] < 0
    velocity = np.zeros_like(x)
    velocity[~wall, 0] = SHEAR * x[~wall, -1]
    n = len(x)
    x = x + np.random.default_rng(2).uniform(-jitter, jitter, x.shape) * DP
    rho0 = np.where(wall, 2700.0, 1000.0)
    return StillFrame(
        position=x, velocity=velocity, mass=rho0 * DP**dim, density=rho0,
        pressure=np.where(wall, 1e9, 9800.0 * (DEPTH - x[:, -1])),
        smoothing_length=np.full(n, 1.2 * DP), material=np.where(wall, 0, 1).astype(np.int32),
        motion=np.where(wall, FIXED, FREE).astype(np.int32),
    )  # fmt: skip


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request):
    return request.param


@pytest.fixture
def scenario_of(tmp_path):
    """The scenario with a gauge."""

    def load(gauge, dim=2, top="slope = 0", tail=""):
        file = tmp_path / "case.toml"
        file.write_text(TOP.format(dim=dim, top=top) + gauge + tail)
        return load_scenario(str(file))

    return load


@pytest.fixture
def read(scenario_of):
    """The rows that a gauge reads from a frame, without their time."""

    def rows(gauge, simulation, dim=2, top="slope = 0"):
        (reader,) = build_gauges(scenario_of(gauge, dim, top), ["bed", "water"])
        found = np.array(reader.read(simulation))
        assert found.shape[1] == len(reader.header)
        np.testing.assert_array_equal(found[:, 0], simulation.time)
        return found[:, 1:]

    return rows


def at(dim, *point):
    """TOML of a point: x, z or x, y, z."""
    x, z = point
    return str([x, z] if dim == 2 else [x, 0.2, z])


def height(dim, x=0.2, z=0.0, more=""):
    return f'kind = "surface_height"\nposition = {at(dim, x, z)}\n{more}'


def test_the_kernel_is_normalised(dim):
    r = np.linspace(0, 0.3, 20_001)
    shell = 2 * np.pi * r if dim == 2 else 4 * np.pi * r**2
    assert np.trapezoid(kernel(r, 0.3, dim) * shell, r) == pytest.approx(1, rel=1e-6)


@pytest.mark.parametrize("off", [-5.0, -2.9, -1.0, 0.4, 1.0])
def test_columns_of_an_approach_begin_on_the_bed(read, dim, off):
    """Wherever they are said to stand."""
    along = [1] + [0] * (dim - 1)
    gauge = f'kind = "approach"\nposition = {at(dim, 0.2, off * DP)}\ndirection = {along}\n'
    ((depth, speed, density),) = read(gauge, frame(dim), dim)
    assert depth == pytest.approx(DEPTH, abs=0.45 * DP)
    assert speed == pytest.approx(0.5 * SHEAR * DEPTH, rel=0.06)
    assert density == pytest.approx(1000.0)


def test_the_depth_of_a_valley_is_the_mean_across(read):
    """Of water up to z = 0.2 over a bed that rises to both sides from the middle."""

    def bed(x):
        return 0.5 * np.abs(x[:, 1] - 0.2)

    axes = [DP * (np.arange(20) + 0.5)] * 2 + [DP * (np.arange(-4, 10) + 0.5)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    x = x[x[:, 2] > bed(x) - 3 * DP]
    wall = x[:, 2] < bed(x)
    rho = np.where(wall, 2700.0, 1000.0)
    valley = StillFrame(
        position=x, velocity=np.zeros_like(x), mass=rho * DP**3, density=rho, pressure=0 * rho,
        material=np.where(wall, 0, 1).astype(np.int32),
        motion=np.where(wall, FIXED, FREE).astype(np.int32),
    )  # fmt: skip
    gauge = 'kind = "approach"\nposition = [0.2, 0, 0]\ndirection = [1, 0, 0]\nwidth = 0.4\n'
    ((depth, *_),) = read(gauge, valley, 3)
    assert depth == pytest.approx(0.15, abs=0.3 * DP)


@pytest.mark.parametrize("jitter", [0.0, 0.2])
def test_height_of_still_water(read, dim, jitter):
    found = read(height(dim), frame(dim, jitter=jitter), dim)
    assert found[0, 0] == pytest.approx(DEPTH, abs=(0.02 + 0.5 * jitter) * DP)


def test_a_dry_bed_has_no_height(read, dim):
    assert read(height(dim), frame(dim, lambda x: x[:, -1] > 9), dim)[0, 0] == 0.0


def test_one_layer_of_particles_is_seen(read, dim):
    film = frame(dim, lambda x: x[:, -1] < DP)
    assert read(height(dim), film, dim)[0, 0] == pytest.approx(DP, abs=0.25 * DP)


def test_spray_does_not_count(read, dim):
    def below_half_or_high(x):
        return (x[:, -1] < 0.1) | ((x[:, -1] > 0.17) & (np.abs(x[:, 0] - 0.2) < 0.02))

    found = read(height(dim), frame(dim, below_half_or_high), dim)
    assert found[0, 0] == pytest.approx(0.1, abs=0.05 * DP)


def test_a_flow_that_hovers_above_the_bed_is_seen(read, dim):
    """As far as the kernel reaches; what is higher is spray."""
    low = frame(dim, lambda x: (x[:, -1] > 2 * DP) & (x[:, -1] < 6 * DP))
    assert read(height(dim), low, dim)[0, 0] == pytest.approx(6 * DP, abs=0.05 * DP)
    high = frame(dim, lambda x: x[:, -1] > 4 * DP)
    assert read(height(dim), high, dim)[0, 0] == 0.0


@pytest.mark.parametrize("size", [1.5 * DP, 5 * DP])
@pytest.mark.parametrize("middle", [0.0, 0.08, DEPTH])
def test_a_body_that_passes_does_not_end_the_column_of_water(read, dim, size, middle):
    """On the bed, under water, and half out of it, seen or not seen by the gauge."""
    flow = frame(dim, lambda x: (x[:, -1] < DEPTH) | _is_near(x, middle, size))
    body = _is_near(flow.fields["position"], middle, size) & (flow.fields["motion"] == FREE)
    flow.fields["motion"][body], flow.fields["material"][body] = BOUND, 0
    found = read(height(dim, more='material = "water"'), flow, dim)
    assert found[0, 0] == pytest.approx(DEPTH, abs=0.25 * DP if middle < DEPTH else size)


def _is_near(x, middle, size):
    offset = x[:, [0, -1]] - np.array([0.2, middle])
    return (offset**2).sum(axis=1) < size**2


def test_height_is_measured_from_the_position(read, dim):
    found = read(height(dim, z=0.06), frame(dim), dim)
    assert found[0, 0] == pytest.approx(DEPTH - 0.06, abs=0.02 * DP)


def test_height_is_against_gravity_unless_told(read):
    """A slope of 20 degrees: depth is vertical, thickness normal to the bed."""
    vertical = read(height(2, x=0.15), frame(2), top="slope = 20")[0, 0]
    assert vertical == pytest.approx(DEPTH / np.cos(np.radians(20)), abs=0.05 * DP)
    normal = read(height(2, more="direction = [0, 2]"), frame(2), top="slope = 20")[0, 0]
    assert normal == pytest.approx(DEPTH, abs=0.02 * DP)


def test_periodic_images_are_seen(read):
    periodic = 'slope = 0\nperiodic = ["x"]\ndomain_min = [0, -1]\ndomain_max = [0.4, 1]'
    inside = read(height(2), frame(2), top=periodic)[0, 0]
    assert read(height(2, x=0.0), frame(2), top=periodic)[0, 0] == pytest.approx(inside, abs=1e-9)
    assert read(height(2, x=0.4), frame(2), top=periodic)[0, 0] == pytest.approx(inside, abs=1e-9)


def test_a_material_can_be_chosen(read, dim):
    assert read(height(dim, more='material = "basalt"'), frame(dim), dim)[0, 0] == 0.0
    assert read(height(dim, more='material = "water"'), frame(dim), dim)[0, 0] > 0.19


def test_profile_of_linear_shear(read, dim):
    gauge = f'kind = "velocity_profile"\nposition = {at(dim, 0.2, 0)}\nlength = 0.3\ncount = 15'
    z, u, *others, fraction = read(gauge, frame(dim), dim).T
    np.testing.assert_allclose(z, (np.arange(15) + 0.5) * 0.02)
    inner = (z > 0.06) & (z < 0.14)
    np.testing.assert_allclose(u[inner], SHEAR * z[inner], rtol=1e-3)
    np.testing.assert_allclose(fraction[z < 0.14], 1.0, atol=0.02)
    assert np.isnan(u[z > DEPTH]).all()
    assert np.isfinite(u[z < DEPTH]).all()
    np.testing.assert_array_equal(np.array(others)[:, z < DEPTH], 0.0)


def test_pressure_is_a_mean_of_the_fluid_alone(read, dim):
    """At the bed the mean is that of the half ball above, and the wall's own pressure is not in."""
    gauge = f'kind = "pressure"\nposition = {at(dim, 0.2, 0)}\nradius = 0.06'
    found = read(gauge, frame(dim), dim)[0, 0]
    assert 9800 * (DEPTH - 0.03) < found < 9800 * DEPTH
    uniform = frame(dim)
    uniform.fields["pressure"][uniform.fields["motion"] == FREE] = 700.0
    assert read(gauge, uniform, dim)[0, 0] == pytest.approx(700.0)
    assert read(gauge, frame(dim, lambda x: x[:, -1] > 0.1), dim)[0, 0] == 0.0


@pytest.mark.parametrize("sign", [1, -1])
def test_discharge_of_linear_shear(read, dim, sign):
    normal = [sign] + [0] * (dim - 1)
    gauge = f'kind = "discharge"\nposition = {at(dim, 0.2, 0)}\ndirection = {normal}\n'
    volume, mass = read(gauge, frame(dim), dim)[0]
    width = 1.0 if dim == 2 else 0.4
    assert volume == pytest.approx(sign * width * 0.5 * SHEAR * DEPTH**2)
    assert mass == pytest.approx(1000 * volume)
    lower = read(gauge + "depth = 0.1", frame(dim), dim)[0, 0]
    assert lower == pytest.approx(0.25 * volume)
    if dim == 3:
        half = read(gauge + "width = 0.1", frame(dim), dim)[0, 0]
        assert half == pytest.approx(0.25 * volume)


def test_discharge_through_an_oblique_section(read):
    gauge = 'kind = "discharge"\nposition = [0.2, 0]\ndirection = [1, 0.5]\nlength = 0.08'
    flow = frame(2)
    flow.fields["velocity"][flow.fields["motion"] == FREE] = [1.0, 0.0]
    assert read(gauge, flow)[0, 0] == pytest.approx(DEPTH, rel=0.02)


def test_force_and_moment():
    position, force = np.array([[1.0, 2.0], [3.0, 0.0]]), np.array([[0.0, 5.0], [2.0, 0.0]])
    total, moment = force_and_moment(position, force, np.array([1.0, 1.0]))
    np.testing.assert_allclose(total, [2, 5])
    np.testing.assert_allclose(moment, [2.0])  # 0*5 - 1*0 + 2*0 - (-1)*2
    total, moment = force_and_moment(np.eye(3), 2 * np.eye(3)[[1, 2, 0]], np.zeros(3))
    np.testing.assert_allclose(moment, [2, 2, 2])


def test_force_sums_fixed_particles_of_its_bodies(scenario_of):
    scenario = scenario_of('kind = "pressure"\nposition = [0, 0]')
    gauge = Force.model_validate(
        {"kind": "force", "bodies": ["bed"], "about": [0.0, 0.0]}, context={"dim": 2}
    )
    state = {
        "body": np.array([0, 0, 1]), "motion": np.array([FIXED, FIXED, FREE]),
        "force": np.array([[1.0, 0], [2, 0], [99, 99]]), "position": np.array([[0, 1.0]] * 3),
        "moment": np.array([0.5, 0.25, 99]),  # of the forces about the particles
    }  # fmt: skip
    simulation = SimpleNamespace(state=lambda: state, time=0.5)
    setting = scenario.setting(["bed", "water"])
    meter = {"contact_impulse": np.array([4.0, 5.0]), "contact_turning": np.array([0.0, 0.0, 6.0])}
    assert gauge.rows(simulation, setting, meter) == [[0.5, 3.0, 0.0, -2.25, 4.0, 5.0, 6.0]]


@pytest.mark.parametrize("dim", [2, 3])
def test_the_core_samples_what_its_state_says(scenario_of, dim):
    simulation, _ = build_simulation(scenario_of(height(dim), dim))
    simulation.advance(limit=0.01, pause=0.01, max_steps=10**6)
    low, high = [0.1] + [-0.05] * (dim - 1), [0.2] + [0.15] * (dim - 1)
    state = simulation.state()
    inside = ((state["position"] >= low) & (state["position"] <= high)).all(axis=1)
    found = simulation.sample(low, high)
    assert inside.sum() > 30
    for name, values in found.items():
        np.testing.assert_allclose(values, state[name][inside], rtol=1e-7, err_msg=name)


@pytest.mark.parametrize(
    ("gauge", "parts"),
    [
        ('position = [0, 0]', ["gauge.g.kind is missing", "surface_height"]),
        ('kind = "pressur"', ['gauge.g.kind = "pressur" is not a kind; did you mean pressure?']),
        ('kind = "pressure"', ["gauge.g.position is missing"]),
        ('kind = "pressure"\nposition = [0, 0]\nradus = 1', ["did you mean radius?"]),
        ('kind = "pressure"\nposition = [0, 0, 0]', ["a 2-D run needs 2 entries"]),
        ('kind = "pressure"\nposition = [0, 0]\ninterval = 0', ["interval = 0 is out of range"]),
        ('kind = "pressure"\nposition = [0, 0]\ninterval = 1e-9', ["interval", "is too short"]),
        ('kind = "pressure"\nposition = [0, 0]\nmaterial = "watr"', ["did you mean water?"]),
        ('kind = "discharge"\nposition = [0, 0]\ndirection = [0, 0]', ["the zero vector"]),
        ('kind = "pressure"\nposition = [0, 0]\nradius = 0.01', ["gauge.g.radius = 0.01 m is"]),
        ('kind = "discharge"\nposition = [0, 0]\ndirection = [1, 0]\nlength = 1e-9',
         ["gauge.g.length = 1e-09 m is smaller than a particle, dp = 0.02 m"]),
        ('kind = "velocity_profile"\nposition = [0, 0]\nlength = 0.01', ["g.length = 0.01 m"]),
        ('kind = "force"\nbodies = ["bed"]', ['kind = "force" needs scheme = "resolved"']),
        ('kind = "force"\nbodies = ["bd"]', ['"bd" is not a known body; did you mean bed?']),
        ('kind = "force"\nbodies = ["water"]', ['"water" is not a fixed body']),
    ],
)  # fmt: skip
def test_wrong_gauges(scenario_of, gauge, parts):
    with pytest.raises(UserError) as caught:
        scenario_of(gauge)
    for part in ("case.toml", *parts):
        assert part in str(caught.value)


def test_a_gauge_outside_the_domain_is_an_error(scenario_of):
    domain = 'slope = 0\nperiodic = ["x"]\ndomain_min = [0, -1]\ndomain_max = [0.4, 1]'
    with pytest.raises(UserError, match=r"gauge\.g\.position = \[0\.5, 0\.0\] lies outside"):
        scenario_of(height(2, x=0.5), top=domain)


def test_a_gauge_far_from_everything_is_doubted(scenario_of):
    for x, doubted in ((0.2, False), (0.6, True)):
        scenario = scenario_of(height(2, x=x))
        simulation, names = build_simulation(scenario)
        doubts = findings(scenario, simulation.state(), names)
        outside = [doubt for doubt in doubts if isinstance(doubt, GaugeOutside)]
        assert [doubt.place for doubt in outside] == ["gauge.g.position"] * doubted


@pytest.mark.parametrize(
    ("figure", "part"),
    [
        ("", "figure.f.gauge is missing"),
        ('gauge = "h"', 'figure.f.gauge = "h" is not a known gauge'),
        ('gauge = "g"\ncolumns = ["heigth"]', "is not a column of g; did you mean height?"),
        ("gauge = 3", "figure.f.gauge = 3 must be a string"),
        ('gauge = "g"\nbin_width = 0.2', "figure.f.bin_width is not a known key"),
        ('gauge = "g"\ntimes = [0.5]', "figure.f.times: g is no profile"),
    ],
)
def test_wrong_figures_of_gauges(scenario_of, figure, part):
    with pytest.raises(UserError) as caught:
        scenario_of(height(2), tail=f'\n[figure.f]\nkind = "gauge"\n{figure}\n')
    assert part in str(caught.value)
