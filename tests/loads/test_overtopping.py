"""Mass over a crest and behind it, and the flow that comes."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from typer.testing import CliRunner

from doseki.assess.loads import AgainstFlow, load_lines, loads_of
from doseki.cli.app import app
from doseki.driver.gauges import outside_everything
from doseki.errors import UserError
from doseki.measure import design
from doseki.measure.loads import body_loads, comes_from_behind, expected_loads
from doseki.measure.overtopping import dam_balances
from doseki.record.reader import GaugeRecord
from doseki.scene.build import build_bodies
from doseki.solver.build import build_simulation

from .scenes import RAIN, RUSH, STREAM, run_of, scenario_of

# Blocks of water that fly over two crests side by side, and through a slit in one.
CRESTS = """
dim = 3
dp = 0.05
scheme = "resolved"
speed_max = 4
time_max = 0.2
time_out = 0.1
gravity = [0, 0, 0]
[body.over]
shape = "box"
material = "water"
velocity = [2, 0, 0]
min = [0, 0, 0.5]
max = [0.3, 0.2, 0.7]
[body.through]
shape = "box"
material = "water"
velocity = [2, 0, 0]
min = [0, 0, 0]
max = [0.3, 0.2, 0.2]
[body.aside]
shape = "box"
material = "water"
velocity = [2, 0, 0]
min = [0, 0.6, 0.4]
max = [0.25, 0.8, 0.6]
[gauge.all]
kind = "overtopping"
position = [0.35, -0.05, 0.35]
direction = [1, 0, 0]
interval = 0.05
[gauge.dam]
kind = "overtopping"
position = [0.35, -0.05, 0.35]
direction = [1, 0, 0]
width = 0.4
interval = 0.05
[gauge.slanted]
kind = "overtopping"
position = [0.35, -0.05, 0.35]
direction = [1, -0.4, 0]
interval = 0.05
[gauge.long]
kind = "overtopping"
position = [-1.65, -5.05, 0.35]
direction = [1, -0.4, 0]
width = 99
interval = 0.05
"""


@pytest.fixture(scope="module")
def crests(tmp_path_factory):
    return run_of(tmp_path_factory.mktemp("crests"), CRESTS)


def test_a_crest_has_ends_and_a_height(crests):
    """What goes by beside it is none of its, what goes through a slit goes not over it."""
    mass = {"over": 12.0, "through": 12.0, "aside": 10.0}
    dam, everything = crests.gauges["dam"], crests.gauges["all"]
    own = mass["over"] + mass["through"]
    assert dam["mass_upstream"][0] == pytest.approx(own)
    assert dam["mass_passed"][-1] == pytest.approx(own)
    assert dam["mass_over"][-1] == pytest.approx(mass["over"])
    assert dam["volume_over"][-1] == pytest.approx(mass["over"] / 1000, rel=0.01)
    assert everything["mass_passed"][-1] == pytest.approx(own + mass["aside"])
    assert everything["mass_over"][-1] == pytest.approx(mass["over"] + mass["aside"])
    for record in (dam, everything):
        residual = record["mass_upstream"][0] + record["mass_supplied"] - record["mass_passed"]
        np.testing.assert_allclose(residual, record["mass_upstream"], atol=1e-9)
    said = dict(load_lines(loads_of(crests)))["dam dam"]
    assert f"{mass['over']:.5g} kg" in said
    assert "of it over the crest" in said


def test_a_crest_as_long_as_the_scene_counts_as_its_plane(crests):
    """Whose crossings the core counts in every step; the plane is aslant."""
    plane, crest = crests.gauges["slanted"], crests.gauges["long"]
    assert np.ptp(plane["mass_passed"]) > 5
    for name in ("mass_passed", "volume_passed", "mass_upstream", "mass_over"):
        np.testing.assert_allclose(crest[name], plane[name], rtol=1e-3, atol=1e-9)


def test_a_record_without_what_went_over_is_read(crests, monkeypatch):
    record = crests.gauges["all"]
    keep = [name for name in record if "over" not in name]
    older = GaugeRecord(
        [f"{name} [{record.units[name]}]" for name in keep],
        [[repr(float(x)) for x in row] for row in zip(*(record[n] for n in keep), strict=True)],
        "all.csv",
    )
    monkeypatch.setattr("doseki.measure.overtopping.gauge_record", lambda *_: older)
    dam = dam_balances(crests)[0]
    assert np.isnan(dam.mass_over)
    assert dam.mass_passed == record["mass_passed"][-1]


def test_a_crest_beside_the_scene_is_named(tmp_path):
    for width in (0.4, 0.3):
        keys = (f"gauge.dam.width={width}", "gauge.dam.position=[0.2, -0.38, 0.35]")
        scenario = scenario_of(tmp_path, CRESTS, *keys)
        outside = outside_everything(scenario, vars(build_bodies(scenario)[0]))
        assert ("dam" in outside) is (width == 0.3)
    with pytest.raises(UserError, match=r"gauge\.dam\.width = 0\.01 m is smaller than a particle"):
        scenario_of(tmp_path, CRESTS, "gauge.dam.width=0.01")


@pytest.fixture(scope="module")
def stream(tmp_path_factory):
    return run_of(tmp_path_factory.mktemp("stream"), STREAM)


@pytest.mark.minutes
def test_masses_close_with_the_ledger(stream):
    """What came is upstream, downstream or has left; the plane itself loses nothing."""
    record, history = stream.gauges["crest"], stream.history
    entered, left, inside = (history[f"mass_{what}"][-1] for what in ("entered", "left", "inside"))
    assert left > 5
    assert record["mass_passed"][-1] > left
    assert record["mass_supplied"][-1] == pytest.approx(entered, rel=1e-12)
    assert record["mass_upstream"][-1] + record["mass_passed"][-1] == pytest.approx(
        entered, rel=1e-9
    )
    downstream = inside - record["mass_upstream"][-1]
    assert record["mass_passed"][-1] == pytest.approx(downstream + left, rel=1e-9)
    for what in ("upstream", "passed"):
        density = record[f"mass_{what}"][-1] / record[f"volume_{what}"][-1]
        assert density == pytest.approx(1000, rel=0.01)
    (dam,) = dam_balances(stream)
    assert abs(dam.residual) < 1e-9 * entered
    assert dam.mass_passed == record["mass_passed"][-1]


@pytest.mark.minutes
def test_nothing_passes_before_the_flow_is_there(stream):
    record = stream.gauges["crest"]
    assert not record["mass_passed"][record["time"] < 0.5].any()
    assert (np.diff(record["mass_passed"]) > -1e-9).all()


def test_grains_count_with_their_mass(tmp_path):
    run = run_of(tmp_path, RAIN, "time_max=0.12")
    record, snapshot = run.gauges["crest"], run[-1]
    past = (snapshot["position"][:, 0] >= 0.4) & ~snapshot["fixed"]
    assert record["mass_upstream"][-1] == pytest.approx(
        snapshot["mass"][~past & ~snapshot["fixed"]].sum()
    )
    first = run[0]
    before = (first["position"][:, 0] >= 0.4) & ~first["fixed"]
    passed = snapshot["mass"][past].sum() - first["mass"][before].sum()
    assert record["mass_passed"][-1] == pytest.approx(passed, abs=1e-9)
    assert record["mass_passed"][0] == 0.0


@pytest.mark.minutes
def test_a_section_sees_the_stream_that_comes(stream):
    """Depth, speed and density of the inflow, 0.6 m behind it; and the discharge they make."""
    record = stream.gauges["before"]
    late = (record["time"] > 1.0) & (record["time"] < 1.3)
    h, v, rho = (record[name][late].mean() for name in ("depth", "velocity", "density"))
    assert h == pytest.approx(0.12, rel=0.05)
    assert v == pytest.approx(2.0, rel=0.05)
    assert rho == pytest.approx(1000, rel=0.01)
    assert h * v == pytest.approx(0.24, rel=0.05)
    assert np.isnan(record["velocity"][0])
    assert record["depth"][0] == 0.0


@pytest.mark.minutes
def test_design_formulas_are_those_of_the_section(stream):
    (load,) = body_loads(stream)
    record = stream.gauges["before"]
    flows = np.isfinite(record["velocity"])
    h, v, rho = (record[name][flows] for name in ("depth", "velocity", "density"))
    expected = {each.formula: each for each in load.design}
    assert expected["rho v2 h b"].force.value == pytest.approx((rho * v**2 * h).max())
    kwan = expected["Kwan (2012), alpha 2.5"].pressure
    assert kwan.value == pytest.approx(2.5 * (rho * v**2).max())
    assert kwan.time == record["time"][flows][np.argmax(rho * v**2)]
    np.testing.assert_allclose(load.direction, [1, 0])
    assert load.boulder is None
    total = load.parts["total"]
    assert total.impulse == pytest.approx(
        sum(load.parts[p].impulse for p in ("static", "dynamic", "contact"))
    )
    assert load.step_peak.value >= total.means[0.01].value >= total.means[0.1].value > 0
    # A stream that is stopped presses with about its momentum, and more as it piles up.
    assert 0.7 < total.means[0.1].value / expected["rho v2 h b"].force.value < 2.5


def test_wider_structures_get_more():
    record = {"time": [0.0], "depth": [0.5], "velocity": [4.0], "density": [1800.0]}
    one, two = (
        expected_loads({k: np.array(v) for k, v in record.items()}, b, 9.81) for b in (1, 2)
    )
    for narrow, wide in zip(one, two, strict=True):
        assert wide.force.value == 2 * narrow.force.value
        if narrow.pressure is not None:
            assert wide.pressure == narrow.pressure


@pytest.mark.parametrize("way", [1, -1])
def test_a_section_that_looks_against_the_flow_is_told(tmp_path, way):
    """In the summary, its text and by the command; formulas do not see what is thrown back."""
    turned = f"gauge.before.direction=[{way}, 0]"
    run = run_of(tmp_path, RUSH, turned)
    found = [each for each in run.summary["warnings"] if "against the flow" in each]
    done = CliRunner().invoke(app, ["loads", str(run.directory)])
    (load,) = body_loads(run)
    assert bool(load.design) == (way > 0)
    if way > 0:
        assert not found
        assert "against" not in done.output
        return
    (said,) = found
    assert said.startswith("gauge.before.direction = [-1, 0] points against the flow")
    assert said.endswith("set it to [1, 0]")
    assert said in run.folder.summary_text.read_text()
    assert said in done.output


def test_a_direction_is_turned_round_as_its_file_has_it():
    said = str(AgainstFlow("gauge.before.direction", (0.123456789, -3.0, 0.0)))
    assert said.startswith("gauge.before.direction = [0.123456789, -3, 0] points")
    assert said.endswith("set it to [-0.123456789, 3, 0]")


def test_a_wave_that_is_thrown_back_makes_no_section_wrong():
    time, rate = np.linspace(0, 4, 5), np.array([np.nan, 2.0, 1.0, -1.0, -1.0])
    record = {"time": time, "depth": np.ones(5), "velocity": rate, "density": np.ones(5)}
    assert not comes_from_behind(record)
    assert comes_from_behind(record | {"velocity": np.array([np.nan, -2.0, -1.0, 1.0, 0.0])})


def test_formulas():
    """Numbers worked out by hand; Huebl and Holzinger's in the form 5 rho v2 Fr^-1.2."""
    h, v, rho, g = 1.5, 6.0, 1900.0, 9.81
    assert design.momentum_flux(h, v, rho) == pytest.approx(102_600)
    assert design.hydrostatic(h, rho, g) == pytest.approx(20_968.875)
    froude = v / np.sqrt(g * h)
    pressure = design.huebl_holzinger(h, v, rho, g)
    assert pressure == pytest.approx(5 * rho * v**2 * froude**-1.2)
    assert design.kwan(v, rho) == pytest.approx(171_000)


def test_a_boulder_by_hertz():
    """4000 v^1.2 R2 kN is Hertz between granite (50 GPa, 0.2) and concrete (20 GPa, 0.2)."""
    v, R = 5.0, 0.6
    modulus = 1 / ((1 - 0.2**2) / 50e9 + (1 - 0.2**2) / 20e9)
    mass = 4 / 3 * np.pi * R**3 * 2650
    overlap = (15 / 16 * mass * v**2 / (modulus * np.sqrt(R))) ** 0.4
    hertz = 4 / 3 * modulus * np.sqrt(R) * overlap**1.5
    assert design.boulder(v, R) == pytest.approx(0.1 * hertz, rel=0.05)


@pytest.mark.minutes
def test_the_command_prints_and_writes_them(stream):
    done = CliRunner().invoke(app, ["loads", str(stream.directory)])
    assert done.exit_code == 0, done.output
    assert "dam crest         past the plane" in done.output
    for word in ("load dam", "rho v2 h b", "Huebl & Holzinger (2003)", "over 10 ms"):
        assert word in done.output
    contents = json.loads((stream.directory / "loads.json").read_text())
    with (stream.directory / "loads.csv").open() as file:
        rows = list(csv.reader(file))
    (load,) = body_loads(stream)
    said = contents["bodies"]["dam"]["parts"]["total"]
    assert said["impulse"] == load.parts["total"].impulse
    impulse = next(row for row in rows if row[:3] == ["dam", "total", "impulse"])
    assert float(impulse[3]) == said["impulse"]
    assert impulse[4] == "N s/m"


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (
            'kind = "load"\nbodies = ["dam"]\napproach = "crest"',
            'kind "overtopping", not "approach"',
        ),
        ('kind = "load"\nbodies = ["dam"]\napproach = "befor"', "did you mean.*before"),
        ('kind = "load"\nbodies = ["dam"]\nwidth = 2', "width"),
        ('kind = "load"\nbodies = ["river"]', "river"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, table, said):
    with pytest.raises(UserError, match=said):
        build_simulation(scenario_of(tmp_path, f"{STREAM}\n[gauge.bad]\n{table}\n"))


@pytest.mark.parametrize(
    ("position", "direction", "outside"),
    [
        ([50.0, 0.0], [1, 0], True),
        ([-50.0, 0.0], [1, 0], True),
        ([0.0, 50.0], [1, 4], True),
        ([0.4, 50.0], [1, 0], False),  # the plane passes through all of the height
        ([50.2, 50.0], [1, -1], False),
    ],
)
def test_a_plane_beside_all_of_the_scene_is_named(tmp_path, position, direction, outside):
    keys = (f"gauge.crest.position={position}", f"gauge.crest.direction={direction}")
    scenario = scenario_of(tmp_path, STREAM, *keys)
    state = vars(build_bodies(scenario)[0])
    found = outside_everything(scenario, state)
    assert ("crest" in found) is outside
